"""Which channel is late, and its correction."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import UNEVEN_SAMPLES_SHARE
from rthm_analysis.diagnosis.faults.lateness import Late, late
from rthm_analysis.diagnosis.faults.naming import fault_of, in_words
from rthm_analysis.diagnosis.faults.relations import Wire, wires_of
from rthm_analysis.diagnosis.faults.smooth import channel_at
from rthm_analysis.diagnosis.faults.stretches import with_column
from rthm_analysis.diagnosis.replay.evidence import MOTION, Channel, Evidence
from rthm_analysis.diagnosis.result import Fault
from rthm_analysis.diagnosis.signals import ahead, filled

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


def find_delays(evidence: Evidence, spec: Spec) -> tuple[Evidence, list[Fault]]:
    """Find channels that are late or early by a constant time, and move them back.

    A velocity is compared with the rate of its position, an acceleration with that of the velocity, or of the
    position. Where the two disagree and the dof has a wire whose force and motor were measured, these say
    whether the position is late; where there are no wires, the one behind the other is late; else the rate is
    taken to be.
    """
    assert spec.plant is not None
    faults: list[Fault] = []
    for dof, family in product(spec.plant.dofs, MOTION[1:]):
        evidence, found = _kinematic(evidence, spec, Channel(family, dof))
        faults += found
    for wire in wires_of(spec):
        evidence, found = _elastic(evidence, wire)
        faults += found
    return evidence, faults


def _kinematic(evidence: Evidence, spec: Spec, channel: Channel) -> tuple[Evidence, list[Fault]]:
    """Compare a velocity or an acceleration with the rate of the motion that is nearest to it."""
    slower = MOTION[MOTION.index(channel.family) - 1 :: -1]
    known = [
        (k, x)
        for k, one in enumerate(slower, 1)
        if (x := channel_at(evidence, one, channel.place)) is not None
    ]
    if channel not in evidence.channels or not known:
        return evidence, []
    (rate, x), v = known[0], evidence.channels.index(channel)
    slow, fast = (filled(evidence.measured[:, column]) for column in (x, v))
    found = late(slow, fast, _step(evidence), rate=rate)
    if found is None:
        return evidence, []
    if evidence.channels[x].family == "position" and _position_is_late(evidence, spec, channel.place, found):
        return _corrected(evidence, x, -found.delay)
    return _corrected(evidence, v, found.delay)


def _elastic(evidence: Evidence, wire: Wire) -> tuple[Evidence, list[Fault]]:
    """Compare a force with the elongation of its wire."""
    names = ("force", wire.actuator), ("motor", wire.actuator), ("position", wire.dof)
    force, motor, position = (channel_at(evidence, *name) for name in names)
    if force is None or motor is None or position is None:
        return evidence, []
    longer = filled(evidence.measured[:, motor]) - filled(evidence.measured[:, position])
    found = late(longer, filled(evidence.measured[:, force]), _step(evidence))
    return (evidence, []) if found is None else _corrected(evidence, force, found.delay)


def moved_back(evidence: Evidence, late: Mapping[Channel, float]) -> tuple[Evidence, tuple[Fault, ...]]:
    """Move channels back that come late by so many seconds, and tell them."""
    faults: list[Fault] = []
    for channel, delay in late.items():
        evidence, found = _corrected(evidence, evidence.channels.index(channel), delay)
        faults += found
    return evidence, tuple(faults)


def _corrected(evidence: Evidence, column: int, delay: float) -> tuple[Evidence, list[Fault]]:
    fault = _fault(evidence.channels[column], delay)
    return with_column(evidence, column, _moved(evidence, column, delay)), [fault]


def _step(evidence: Evidence) -> float:
    return float(np.median(np.diff(evidence.time)))


def _position_is_late(evidence: Evidence, spec: Spec, dof: str, found: Late) -> bool:
    """Whether the position is what comes late, or early, as the force in a wire at the dof says; without
    wires, whether it comes behind its rate: filters and buses delay, and none is ahead of its time.
    """
    if evidence.driven_by == "force":
        return found.delay < 0.0
    for wire in wires_of(spec):
        columns = [
            channel_at(evidence, *name)
            for name in (("force", wire.actuator), ("motor", wire.actuator), ("position", dof))
        ]
        if wire.dof != dof or any(column is None for column in columns):
            continue
        force, motor, position = (filled(evidence.measured[:, c]) for c in columns if c is not None)
        there = motor - force / wire.stiffness
        shifted = _wire_misfit(there, _earlier(position, -found.delay / _step(evidence)))
        return shifted < _wire_misfit(there, position)
    return False


def _earlier(values: Floats, samples: float) -> Floats:
    """A signal as it was so many samples later."""
    at = np.arange(values.size, dtype=float)
    return np.interp(at + samples, at, values)


def _wire_misfit(there: Floats, position: Floats) -> float:
    """Variance that a position leaves of the far end of a wire, drawn from its force."""
    basis = np.column_stack([position, np.ones_like(position)])
    left = there - basis @ np.linalg.lstsq(basis, there, rcond=None)[0]
    return float(np.mean(np.square(left)))


def _moved(evidence: Evidence, column: int, delay: float) -> Floats:
    """Channel with its stamps moved back; NaN where nothing is known then."""
    values, time, step = evidence.measured[:, column], evidence.time, _step(evidence)
    if float(np.std(np.diff(time))) < UNEVEN_SAMPLES_SHARE * step:
        return ahead(values, delay / step)
    known = np.isfinite(values)
    moved = np.interp(time + delay, time, filled(values), left=np.nan, right=np.nan)
    gap = np.interp(time + delay, time, (~known).astype(float)) > 0.0
    return np.where(gap, np.nan, moved)


def _fault(channel: Channel, delay: float) -> Fault:
    way = "late" if delay > 0.0 else "early"
    words = (
        f"{in_words(channel, first=True)} comes {1e3 * abs(delay):.3g} ms {way} in the recording, as a "
        "constant delay. It was moved back for this diagnosis; correct the stamps of its sensor, or the "
        "filter that delays it."
    )
    return fault_of(channel, "channel_delay", words, value=delay)
