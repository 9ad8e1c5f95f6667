"""Signs, units and swapped channels, told to a test engineer."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.faults.naming import fault_of, in_words, role_of
from rthm_analysis.diagnosis.faults.unit_ratios import unit_of
from rthm_analysis.diagnosis.replay.evidence import Channel
from rthm_analysis.diagnosis.result import Fault

FACTORS = ("sign", "unit")
"""Faults that multiply every sample of a signal."""

SHOWN_BY = {
    "position": "the position that the wire's force and the motor give",
    "velocity": "the rate of the recorded position",
    "acceleration": "the rate of the recorded motion",
    "motor": "the commands",
    "force": "what the wire's stiffness makes of its elongation",
    "load": "the force that the recorded motion needs",
}
"""What a family should be."""


def factor_fault(channel: Channel, factor: float, shown_by: str = "") -> Fault:
    """Fault of a channel that is so many times what it should be."""
    name, other = in_words(channel, first=True), shown_by or SHOWN_BY[channel.family]
    role = role_of(channel)
    if abs(factor) == 1.0:
        words = (
            f"{name} is recorded with the wrong sign: it is -1 times {other}. It was "
            "turned round for this diagnosis; correct the sign of the sensor, or import it with --unit "
            f"{role}=-1."
        )
        return fault_of(channel, "sign", words, value=-1.0)
    unit = unit_of(factor, channel.family)
    likely = f", as in {unit}" if unit else ""
    turned = " and the wrong sign" if factor < 0.0 else ""
    words = (
        f"{name} is recorded in another unit{turned}: it is {factor:.4g} times {other}{likely}. It "
        "was converted for this diagnosis; import it with --unit "
        f"{role}={np.format_float_positional(1.0 / factor, 6, fractional=False, trim='-')}."
    )
    return fault_of(channel, "unit", words, value=factor)


def swapped_fault(one: Channel, other: Channel) -> Fault:
    """Fault of two channels that are in each other's place."""
    words = (
        f"{in_words(one, first=True)} and {in_words(other)} are in each other's place: exchanged, they agree "
        "with all other channels. They were exchanged for this diagnosis; correct the wiring, or the "
        "columns of the import."
    )
    return fault_of(one, "swapped", words)
