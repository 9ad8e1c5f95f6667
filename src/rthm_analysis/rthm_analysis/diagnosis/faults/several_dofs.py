"""Positions of a plant with several dofs that a known force drives: their signs, units and places.

The force is what masses, dampers and springs make of the motion. Each dof has a share in it, and a position
that is recorded as so many times the true one asks for so much less of its share.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import LOAD_CORRELATION
from rthm_analysis.diagnosis.faults.known_loads import corrected_position
from rthm_analysis.diagnosis.faults.scaling import factor_fault, swapped_fault
from rthm_analysis.diagnosis.faults.smooth import Smooth, smoothed
from rthm_analysis.diagnosis.faults.unit_ratios import known_factor
from rthm_analysis.diagnosis.replay.evidence import MOTION, Channel, Evidence
from rthm_analysis.diagnosis.result import Fault
from rthm_core.spec.sections import MATRICES

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec

SHOWN = "what the known force and the other positions ask for"


def find_positions(evidence: Evidence, spec: Spec) -> tuple[Evidence, list[Fault]]:
    """Find positions of several dofs with another sign or unit, or in each other's place, and correct them;
    where all have the same, it is the known force that has another.
    """
    assert spec.plant is not None
    dofs = spec.plant.dofs
    channels = [Channel("position", dof) for dof in dofs]
    known = set(channels) <= {*evidence.channels}
    if evidence.driven_by != "force" or len(dofs) < 2 or not known or not evidence.load.any():
        return evidence, []
    smooth = smoothed(evidence, dofs, ())
    if smooth is None:
        return evidence, []
    factors = _factors(smooth, spec, list(range(len(dofs))))
    if factors is None:
        return _exchanged(evidence, spec, smooth)
    if len({*factors}) == 1 and factors[0] != 1.0:
        return _of_load(evidence, spec, 1.0 / factors[0])
    faults: list[Fault] = []
    for channel, factor in zip(channels, factors, strict=True):
        if factor != 1.0:
            evidence, found = corrected_position(evidence, channel, factor, SHOWN)
            faults += found
    return evidence, faults


def _factors(smooth: Smooth, spec: Spec, order: list[int]) -> list[float] | None:
    """Recorded over true value of each position, taken in some order; None where the known force is not what
    they make of it, or one is neither a sign nor a unit.
    """
    assert spec.plant is not None
    dofs, n = spec.plant.dofs, len(spec.plant.dofs)
    m, c, k = (np.reshape(getattr(spec.plant, name), (n, n)) for name in MATRICES)
    columns = []
    for row, at in enumerate(order):
        x, v, a = (one["position", dofs[at]] for one in (smooth.values, smooth.rates, smooth.seconds))
        columns.append(np.concatenate([m[i, row] * a + c[i, row] * v + k[i, row] * x for i in range(n)]))
    nothing = np.zeros(smooth.rows.size)
    force = np.concatenate([smooth.values.get(("load", dof), nothing) for dof in dofs])
    shares, needed = _fitted(np.stack(columns, axis=1), force)
    if np.corrcoef(needed, force)[0, 1] < LOAD_CORRELATION:
        return None
    found = [known_factor(1.0 / share, "position") if share else None for share in shares]
    return [one for one in found if one is not None] if None not in found else None


def _fitted(columns: Floats, force: Floats) -> tuple[list[float], Floats]:
    """Shares of columns (p, n) in a force (p,) that leave least of it, and their sum."""
    scale = np.linalg.norm(columns, axis=0) + 1e-300
    shares = np.linalg.lstsq(columns / scale, force, rcond=None)[0] / scale
    return shares.tolist(), columns @ shares


def _exchanged(evidence: Evidence, spec: Spec, smooth: Smooth) -> tuple[Evidence, list[Fault]]:
    """Exchange the two dofs whose motions are then what the known force asks for, if there are such."""
    assert spec.plant is not None
    dofs = spec.plant.dofs
    for i, j in combinations(range(len(dofs)), 2):
        order = list(range(len(dofs)))
        order[i], order[j] = j, i
        if set(_factors(smooth, spec, order) or [0.0]) == {1.0}:
            return _with_exchanged(evidence, dofs[i], dofs[j])
    return evidence, []


def _with_exchanged(evidence: Evidence, dof: str, other: str) -> tuple[Evidence, list[Fault]]:
    """Exchange positions, and their rates with them: these agree."""
    measured, faults = evidence.measured.copy(), []
    for family in MOTION:
        pair = Channel(family, dof), Channel(family, other)
        if set(pair) <= {*evidence.channels}:
            columns = [evidence.channels.index(one) for one in pair]
            measured[:, columns] = measured[:, columns[::-1]]
            faults.append(swapped_fault(*pair))
    return replace(evidence, measured=measured), faults


def _of_load(evidence: Evidence, spec: Spec, factor: float) -> tuple[Evidence, list[Fault]]:
    """Correct the known force: so many times what the motion asks for."""
    assert spec.plant is not None
    driven = [dof for dof, load in zip(spec.plant.dofs, evidence.load.T, strict=True) if np.any(load)]
    faults = [factor_fault(Channel("load", dof), factor) for dof in driven]
    return replace(evidence, load=evidence.load / factor), faults
