"""What a sweep finds out about one loop."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.stability import slowest
from rthm_core.compiled import Floats
from rthm_core.energy import TERMS, with_error
from rthm_core.engine import Trajectory, simulate
from rthm_core.errors import InputError
from rthm_core.kept import kept_without_timing
from rthm_core.substructure import interface

if TYPE_CHECKING:
    from rthm_core.spec import Spec

STABILITY = ("spectral_radius", "growth_rate", "frequency", "damping_ratio")
"""Of the linear part; frequency and damping ratio are those of the mode that fades most slowly."""

ENERGIES = (*TERMS, "E_err", "E_total", "balance_error")
MOTION = ("equivalent_damping", "max_error", "rms_error")
"""Damper between plant and ground that drains what E_err does, N s/m; distance of the plant from the ideal
system, m."""

QUANTITIES = (*STABILITY, *ENERGIES, *MOTION)

FEWEST_INSTANTS = 2000
"""Rows of a simulation, at least; the energies do not depend on them."""

LONGEST_STEP = 0.01


def measure(spec: Spec, duration: float) -> tuple[dict[str, float], str]:
    """Quantities of one loop, and a sentence if its stability cannot be told.

    What cannot be told is nan; so is all that needs a simulation when `duration` (s) is zero.
    """
    found, refused = dict.fromkeys(QUANTITIES, np.nan), ""
    try:
        found |= _stability(spec)
    except InputError as error:
        refused = str(error)
    if duration > 0.0:
        sample = min(duration / FEWEST_INSTANTS, LONGEST_STEP)
        hybrid = simulate(spec, duration, sample)
        found |= _energies(hybrid)
        found |= _motion(spec, hybrid, _ideal_position(spec, duration, sample))
    return {name: float(value) for name, value in found.items()}, refused


def _stability(spec: Spec) -> dict[str, float]:
    radius, hyperperiod, mode = slowest(spec)
    return {
        "spectral_radius": radius,
        "growth_rate": float(np.log(radius) / hyperperiod),
        "frequency": mode.frequency,
        "damping_ratio": mode.damping_ratio,
    }


@kept_without_timing
def _ideal_position(spec: Spec, duration: float, sample: float) -> Floats:
    """Plant (N, n) of the ideal system, which has neither delays nor holds."""
    return simulate(spec, duration, sample, "ideal", energies=False).plant_position


def _energies(hybrid: Trajectory) -> dict[str, float]:
    last = with_error({name: values[-1:] for name, values in hybrid.energies.items()})
    return {name: float(value[0]) for name, value in last.items()} | {
        "balance_error": float(np.abs(hybrid.balance_error).max())
    }


def _motion(spec: Spec, hybrid: Trajectory, ideal: Floats) -> dict[str, float]:
    error = hybrid.plant_position - ideal
    passed = _integral(hybrid.t, np.sum(hybrid.plant_velocity[:, interface(spec).plant] ** 2, axis=1))
    drained = -sum(float(hybrid.energies[name][-1]) for name in ("E_num", "E_ff", "E_fx"))
    return {
        "equivalent_damping": drained / passed if passed > 0.0 else np.nan,
        "max_error": float(np.abs(error).max()),
        "rms_error": float(np.sqrt(np.mean(error**2))),
    }


def _integral(t: Floats, values: Floats) -> float:
    return float(np.sum(0.5 * np.diff(t) * (values[1:] + values[:-1])))
