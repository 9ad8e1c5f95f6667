"""Channels with another sign or unit, or in each other's place: what makes all relations hold again."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import (
    OPEN_VARIANCE_SHARE,
    OWN_FACTOR_CORRELATION,
    OWN_FACTOR_VARIANCE_SHARE,
    RELATED_CORRELATION,
    SWAP_LOG_GAIN,
)
from rthm_analysis.diagnosis.faults.relations import (
    Name,
    Relation,
    Wire,
    accelerated,
    corrected,
    exchanged,
    followed,
    kinematic,
    related,
    relations,
    wire_signals,
    wires_of,
)
from rthm_analysis.diagnosis.faults.scaling import factor_fault, swapped_fault
from rthm_analysis.diagnosis.faults.smooth import Smooth, channel_at, smoothed
from rthm_analysis.diagnosis.faults.unit_ratios import known_factor
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_analysis.diagnosis.result import Fault

if TYPE_CHECKING:
    from rthm_core.spec import Spec


def find_factors(evidence: Evidence, spec: Spec) -> tuple[Evidence, list[Fault]]:
    """Find signs, units and swapped channels, and correct them.

    A channel is corrected only if afterwards every relation that spoke against the recording holds beyond
    doubt, and none that held has been lost.
    """
    assert spec.plant is not None
    dofs, wires = spec.plant.dofs, wires_of(spec)
    names = spec.actuator.names if spec.actuator else ()
    smooth = smoothed(evidence, dofs, names)
    if smooth is None:
        return evidence, []
    before = relations(smooth, dofs, wires)
    if all(one.holds for one in before):
        return evidence, []
    factors = _factors(smooth, dofs, wires)
    after = relations(corrected(smooth, factors), dofs, wires)
    as_factors = _quality(before, after) if factors else 0.0
    pair, as_swap = _swap(smooth, dofs, wires, before)
    if max(as_factors, as_swap) <= 0.0:
        return evidence, []
    if pair is not None and as_swap > as_factors + SWAP_LOG_GAIN:
        return _swapped(evidence, pair)
    measured = {name: factor for name, factor in factors.items() if name[0] != "command"}
    return scaled(evidence, measured), [factor_fault(Channel(*one), by) for one, by in measured.items()]


def scaled(evidence: Evidence, factors: dict[Name, float]) -> Evidence:
    """Evidence whose channels are divided by their factors."""
    measured = evidence.measured.copy()
    for name, factor in factors.items():
        column = channel_at(evidence, *name)
        if column is not None:
            measured[:, column] /= factor
    return replace(evidence, measured=measured)


def _quality(before: list[Relation], after: list[Relation]) -> float:
    """How little the relations leave open once corrected; 0 where that is no clear and complete
    improvement.
    """
    better = [b for a, b in zip(before, after, strict=True) if not a.holds and b.sound]
    worse = [b for a, b in zip(before, after, strict=True) if a.holds and not b.holds]
    left = [b for b in after if not b.holds and abs(b.correlation) > RELATED_CORRELATION]
    if not better or worse or left:
        return 0.0
    return -sum(float(np.log(max(1.0 - one.correlation**2, OPEN_VARIANCE_SHARE))) for one in after)


def _factors(smooth: Smooth, dofs: tuple[str, ...], wires: tuple[Wire, ...]) -> dict[Name, float]:
    """Recorded over true value of each signal that has another sign or unit.

    Commands are what they are; they tell the motors, motors tell the positions at the other end of their
    wires, and each motion tells its rate.
    """
    found: dict[Name, float] = {}
    for wire in wires:
        motor = followed(smooth, wire)
        if motor is not None and abs(motor.correlation) > RELATED_CORRELATION:
            _note(found, ("motor", wire.actuator), motor.gain)
        _note_wire(found, smooth, wire)
    for dof in dofs:
        for relation in (kinematic(smooth, dof), accelerated(smooth, dof)):
            if relation is not None and abs(relation.correlation) > RELATED_CORRELATION:
                slow, rate = relation.signals
                _note(found, rate, relation.gain * found.get(slow, 1.0))
    return found


def _note(found: dict[Name, float], name: Name, gain: float, more: float = 0.0) -> None:
    factor = known_factor(gain, name[0], more)
    if factor is not None and factor != 1.0:
        found[name] = factor


def _note_wire(found: dict[Name, float], smooth: Smooth, wire: Wire) -> None:
    """Factors of position and force, from the parts of motor and position in the force."""
    names = wire_signals(smooth, wire)
    if names is None:
        return
    force, motor, position = names
    over = found.get(motor, 1.0)
    told = np.column_stack([smooth.values[motor] / over, smooth.values[position]])
    told = told - told.mean(axis=0)
    wanted = smooth.values[force] - smooth.values[force].mean()
    size = np.sqrt(np.mean(np.square(told), axis=0))
    if not (size > 0.0).all() or not np.any(wanted):
        return
    parts = np.linalg.lstsq(told / size, wanted, rcond=None)[0] / size
    if _multiple(told @ parts, wanted) > OWN_FACTOR_CORRELATION and _telling(parts, size, wanted):
        _note(found, position, float(-parts[0] / parts[1]))
    longer = told[:, 0] - told[:, 1] / found.get(position, 1.0)
    gain, correlation = related(wire.stiffness * longer, wanted)
    if abs(correlation) > OWN_FACTOR_CORRELATION:
        _note(found, force, gain, 2.0 * wire.uncertainty)


def _multiple(fitted: np.ndarray, wanted: np.ndarray) -> float:
    return related(fitted, wanted)[1] if np.any(fitted) else 0.0


def _telling(parts: np.ndarray, size: np.ndarray, wanted: np.ndarray) -> bool:
    """Whether motor and position each make a good part of the force."""
    return bool(np.all(np.square(parts * size) > OWN_FACTOR_VARIANCE_SHARE * np.mean(np.square(wanted))))


def _swap(
    smooth: Smooth, dofs: tuple[str, ...], wires: tuple[Wire, ...], before: list[Relation]
) -> tuple[tuple[Name, Name] | None, float]:
    """Two channels that must have changed places, and how well all relations hold then."""
    measured = [name for name in smooth.values if name[0] not in ("command", "load")]
    tried = [
        ((one, other), _quality(before, relations(exchanged(smooth, one, other), dofs, wires)))
        for one, other in combinations(measured, 2)
    ]
    return max(tried, key=lambda one: one[1], default=(None, 0.0))


def _swapped(evidence: Evidence, pair: tuple[Name, Name]) -> tuple[Evidence, list[Fault]]:
    one, other = (Channel(*name) for name in pair)
    columns = [evidence.channels.index(one), evidence.channels.index(other)]
    measured = evidence.measured.copy()
    measured[:, columns] = measured[:, columns[::-1]]
    return replace(evidence, measured=measured), [swapped_fault(one, other)]
