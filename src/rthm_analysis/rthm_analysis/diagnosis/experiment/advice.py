"""What to do next where no computed input helps: software is compared, sensors are checked at known values,
and drives are moved by themselves.
"""

from __future__ import annotations

from rthm_analysis.diagnosis.faults.clipped import SATURATED
from rthm_analysis.diagnosis.faults.leaks import CROSSTALK
from rthm_analysis.diagnosis.faults.rectified import RECTIFIED
from rthm_analysis.diagnosis.physical.zeros_told import OFFSET
from rthm_analysis.diagnosis.result import WRONG_ENTRY
from rthm_core.effects import effect

SOFTWARE = ("link", "numerical", "controller")
"""Families of blocks that no motion of the rig says more about."""

FAULT = {
    "sign": "Push the {channel} by hand in the + direction of the spec and see which way the reading goes; "
    "then import the recording again with the sign corrected.",
    "unit": "Look up the unit of {channel} in the logger, and import the recording again with it.",
    "swapped": "Move one dof by hand and see which channel answers; then correct the names.",
    "channel_delay": "Tap the rig once, and compare the instants at which the channels show it.",
    "stuck": "Check cable and supply of {channel}, and record again.",
    SATURATED: "Give {channel} more range, or repeat the test with less motion.",
    RECTIFIED: "Record {channel} before its rectifier, or with a sensor that knows the direction.",
    "spikes": "Check the shielding and the connectors of {channel}, and record again.",
    "dropout": "Check cable, network and logger of {channel}, and record again.",
    OFFSET: "Rest the rig under no force before every test, and note what {channel} reads: the spec's zero.",
    "hum": "Record {channel} at rest, and with the supplies switched off one by one.",
    "force_lag": "Record the force where it acts, or measure how it follows a step of what is recorded.",
    "force_leak": "Push with a known force on one dof alone, and see what moves at first.",
    CROSSTALK: "Move one dof alone, and see what the sensors of the others read.",
    "clock_drift": "Record both channels with one clock, or with a common pulse once a minute.",
    WRONG_ENTRY: "Compare the spec's {channel} with what the nodes were started with "
    "(`ros2 param dump`), and diagnose again with the right one.",
    "wrong_spec": "Diagnose again with the spec of this test: `rthm diagnose BAG --spec SPEC`.",
}

OF_SENSOR = {
    "sensor.acceleration": "Turn the accelerometer of {place} over: from one side to the other its reading "
    "has to change by 19.61 m/s^2, and at rest to stay as it is.",
}
"""By block: what shows that a sensor is wrong, whatever it is, where no known position or force does."""

LONGER = (
    "A longer recording, or one with larger motion, would show smaller effects than the detection limits say."
)

REPEAT = (
    "Repeat the test at half and at twice the amplitude: what grows faster than the motion is stiffness, "
    "drag or contact; what does not grow is friction or noise."
)


def advice(block: str, kind: str, place: str | None, name: str | None = None) -> str:
    """What to do about a finding, in a sentence or two.

    Parameters
    ----------
    block, kind
        Contract, section 6.
    place : str or None
        Dof or actuator.
    name : str or None
        Entry of the spec that a block that computes has wrong.
    """
    said = OF_SENSOR.get(block) or effect(kind, block).experiment or "Repeat the test at another amplitude."
    return said.format(place=place or block, name=name or block.removeprefix("link."))


def fault_advice(kind: str, channel: str) -> str:
    """What to do about a fault of the recording or of the spec."""
    return FAULT.get(kind, "Check {channel}, and record again.").format(channel=channel)
