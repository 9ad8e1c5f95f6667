"""Dead channels: one value in every sample, while the rest of the rig shows that it should change."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.samples import DEAD_COMMAND_RATIO
from rthm_analysis.diagnosis.faults.naming import fault_of, in_words
from rthm_analysis.diagnosis.replay.evidence import MOTION, UNIT_OF, Channel, Evidence
from rthm_analysis.diagnosis.result import Fault
from rthm_core.spec import Spec


def find_dead(evidence: Evidence, spec: Spec) -> tuple[Evidence, list[Fault]]:
    """Leave out the channels that gave nothing throughout, and tell them.

    A rig, or a part of it, may rest: a channel is dead only where another one denies that.
    """
    dead = [
        column
        for column, channel in enumerate(evidence.channels)
        if _travel(evidence, channel) == 0.0 and _denied(evidence, spec, channel)
    ]
    faults = [_told(evidence, column) for column in dead]
    return (evidence.without(dead), faults) if dead else (evidence, [])


def _denied(evidence: Evidence, spec: Spec, channel: Channel) -> bool:
    """Whether another channel shows that this one should change."""
    if channel.family in MOTION:
        others = (one for one in ("position", "velocity") if one != channel.family)
        return any(_travel(evidence, Channel(one, channel.place)) > 0.0 for one in others)
    goes_slack = any(e.law.changes == "pretension" for e in spec.effects)
    if spec.actuator is None or not evidence.due_ns.size or goes_slack:
        return False
    command = evidence.commands[:, spec.actuator.names.index(channel.place)]
    liveliest = max(_travel(evidence, c) for c in evidence.channels if c.family == "position")
    return float(np.ptp(command)) > DEAD_COMMAND_RATIO * liveliest > 0.0


def _travel(evidence: Evidence, channel: Channel) -> float:
    """Range of a channel; 0 where it is not recorded."""
    if channel not in evidence.channels:
        return 0.0
    values = evidence.measured[:, evidence.channels.index(channel)]
    return float(np.nanmax(values) - np.nanmin(values))


def _told(evidence: Evidence, column: int) -> Fault:
    channel = evidence.channels[column]
    value = float(np.nanmax(evidence.measured[:, column]))
    stood = "the motor stood still, or its sensor" if channel.family == "motor" else "the sensor or its link"
    words = (
        f"{in_words(channel, first=True)} is {value:.4g} {UNIT_OF[channel.family]} in every sample, while "
        f"the rest of the rig moves: {stood} gave nothing. It is left out; check both."
    )
    return fault_of(channel, "stuck" if value else "dropout", words)
