"""The force of a law along a motion that is known."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numba
import numpy as np

from rthm_analysis.component.criteria import MOST_LAW_STEPS, SUBSTEP_ERROR
from rthm_core.compiled import kept, keyed_by
from rthm_core.effects.laws import MOST_PARAMETERS
from rthm_core.physical.laws import PARTITIONS, POSITION, code_of, plant_force, plant_rate

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.effects import PlantLaw


def _compiled(function: Any) -> Any:
    return kept(function, numba.njit(nogil=True, error_model="numpy", no_cfunc_wrapper=True))


compiled: Any = keyed_by(Path(__file__).parent, _compiled)


@compiled
def _mode(partition, thresholds, x, v):  # type: ignore[no-untyped-def]
    if partition == POSITION:
        return int(x > thresholds[0]) + int(x > thresholds[1])
    return 0 if partition == 0 else (1 if v > 0.0 else -1)


@compiled
def _advance(code, partition, thresholds, x, v, t, k, step, substeps, p, z):  # type: ignore[no-untyped-def]
    """Bring the states of a law from sample k to the next, by Runge and Kutta's steps of fourth order."""
    h, size = step / substeps, z.size
    slopes, there = np.empty((4, size)), np.empty(size)
    for i in range(substeps):
        for stage in range(4):
            at = (i + 0.5 * ((stage + 1) // 2)) / substeps
            there[:] = z
            if stage > 0:
                there += (h if stage == 3 else 0.5 * h) * slopes[stage - 1]
            xs = x[k] + at * (x[k + 1] - x[k])
            vs = (x[k + 1] - x[k]) / step
            plant_rate(
                code, xs, vs, there, t[k] + at * step, p, _mode(partition, thresholds, xs, vs), slopes[stage]
            )
        z += h / 6.0 * (slopes[0] + 2.0 * slopes[1] + 2.0 * slopes[2] + slopes[3])


@compiled
def _along(code, partition, thresholds, x, v, t, step, substeps, p, z, out):  # type: ignore[no-untyped-def]
    for k in range(x.size):
        out[k] = plant_force(code, x[k], v[k], z, t[k], p, _mode(partition, thresholds, x[k], v[k]))
        if z.size > 0 and k + 1 < x.size:
            _advance(code, partition, thresholds, x, v, t, k, step, substeps, p, z)


def force_along(
    law: type[PlantLaw], p: Sequence[float], x: Floats, v: Floats, t: Floats, substeps: int = 1
) -> Floats:
    """Force of a law, N, + along +x, at the samples (s,) of a motion at even instants.

    Between samples the motion is a straight line, in which the states of the law take so many steps. They
    begin in steady state at the first sample.

    Examples
    --------
    >>> from rthm_core.effects.registry import effect
    >>> t = np.linspace(0.0, 1.0, 5)
    >>> force_along(effect("cubic_stiffness", "plant"), (2.0,), t, np.ones(5), t).tolist()[-1]
    -2.0
    """
    parameters, thresholds, z = np.zeros(MOST_PARAMETERS), np.full(2, np.inf), np.zeros(law.states)
    parameters[: len(p)] = p
    limits = law.thresholds(tuple(p))
    thresholds[: len(limits)] = limits
    z[:] = law.initial(float(x[0]), tuple(p))
    out = np.empty(x.size)
    partition, step = PARTITIONS.index(law.partition), float(t[1] - t[0])
    code = code_of(law)  # type: ignore[arg-type]
    _along(code, partition, thresholds, x, v, t, step, substeps, parameters, z, out)
    return out


def substeps_for(law: type[PlantLaw], p: Sequence[float], x: Floats, v: Floats, t: Floats) -> int:
    """Steps between two samples with which the force of a law no longer changes."""
    substeps, found = 1, force_along(law, p, x, v, t)
    while law.states and substeps < MOST_LAW_STEPS:
        finer = force_along(law, p, x, v, t, 2 * substeps)
        if np.max(np.abs(finer - found)) <= SUBSTEP_ERROR * np.max(np.abs(finer)):
            break
        substeps, found = 2 * substeps, finer
    return substeps
