"""What to do next where no computed input helps: software is compared, sensors are checked at known values,
and drives are moved by themselves.
"""

from __future__ import annotations

from rthm_core.effects.base import family

SOFTWARE = ("link", "numerical", "controller")
"""Families of blocks that no motion of the rig says more about."""

LINK = {
    "extra_delay": "Compare `rthm timing` of this recording with the spec's {name}: if the ages agree with "
    "the recording, correct the spec; if not, look for buffers between sender and receiver.",
    "jitter": "Record the same test with nothing else running on the receiver's host, and compare "
    "the p99 of {name} in `rthm timing`.",
    "loss": "Count what is sent and what arrives of {name} (`rthm timing`, lost), first with both ends on "
    "one host: that tells the network from the programs.",
    "clock_offset": "Compare the clocks of the two hosts of {name} (`chronyc tracking`), "
    "and record again once they are synchronised.",
}

COMPUTED = {
    "wrong_parameter": "Compare the parameters that the node was started with (`ros2 param dump`) with the "
    "spec: {name} differs. No test of the rig is needed for that.",
}

SENSOR = {
    "bias": "Rest {place} at a position, or under a force, that is known, and read the sensor for ten "
    "seconds.",
    "scale": "Rest {place} at three known positions, or under three known forces, on both sides of zero.",
    "drift": "Record {place} at rest for as long as the test took, after the same warm-up.",
    "lag": "Record steps of {place} together with a faster sensor, or ask the amplifier for its filter.",
    "quantisation": "Move {place} very slowly over ten steps of the reading, and look up the resolution "
    "of the converter.",
}

DRIVE = {
    "lag": "Step the command of {place} by a little with the dof locked.",
    "second_order": "Step the command of {place} by a little with the dof locked, and look for overshoot.",
    "extra_delay": "Step the command of {place} by a little with the dof locked, and compare the time to the "
    "first movement with tau4.",
    "rate_limit": "Step the command of {place} by several sizes, the dof locked: the slope must not grow.",
    "saturation": "Ramp the command of {place} slowly to both ends with the dof free.",
    "quantisation": "Ramp the command of {place} very slowly.",
}

BY_HAND = {
    "coulomb_friction": "Pull {place} back and forth slowly, at constant speed, and read the force.",
    "stribeck_friction": "Start {place} from rest several times, at several low speeds.",
    "quadratic_drag": "Repeat the test at twice the amplitude.",
    "cubic_stiffness": "Pull {place} statically to several displacements on both sides.",
    "quadratic_stiffness": "Pull {place} statically to several displacements on both sides.",
    "end_stop": "Push {place} slowly against the stop.",
    "clearance": "Push {place} slowly through the gap, both ways.",
    "bouc_wen": "Move {place} slowly through growing loops, and draw force over displacement.",
    "maxwell_branch": "Hold {place} after a step, and watch the force relax.",
    "hidden_mode": "Sweep a sine slowly through the suspected resonance.",
    "fluid_memory": "Sweep a sine slowly, and record a decay in air.",
    "harmonic_load": "Record the rig at rest with everything switched on.",
    "constant_load": "Record the rig at rest, before and after turning it over.",
    "backlash": "Reverse the motor slowly under a small load.",
    "slack": "Repeat the test with more pretension.",
    "hardening": "Pull statically at the wire to several elongations.",
    "pulley_inertia": "Sweep the motor with the dof locked.",
    "pulley_friction": "Reverse the motor slowly with the dof locked.",
}

FAULT = {
    "sign": "Push the {channel} by hand in the + direction of the spec and see which way the reading goes; "
    "then import the recording again with the sign corrected.",
    "unit": "Look up the unit of {channel} in the logger, and import the recording again with it.",
    "swapped": "Move one dof by hand and see which channel answers; then correct the names.",
    "channel_delay": "Tap the rig once, and compare the instants at which the channels show it.",
    "stuck": "Check cable and supply of {channel}, and record again.",
    "saturation": "Give {channel} more range, or repeat the test with less motion.",
    "spikes": "Check the shielding and the connectors of {channel}, and record again.",
    "dropout": "Check cable, network and logger of {channel}, and record again.",
    "hum": "Record {channel} at rest, and with the supplies switched off one by one.",
    "clock_drift": "Record both channels with one clock, or with a common pulse once a minute.",
    "wrong_parameter": "Compare the spec's {channel} with what the nodes were started with "
    "(`ros2 param dump`), and diagnose again with the right one.",
    "wrong_spec": "Diagnose again with the spec of this test: `rthm diagnose BAG --spec SPEC`.",
}

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
    where = family(block)
    tables = {"link": LINK, "numerical": COMPUTED, "controller": COMPUTED, "sensor": SENSOR, "motor": DRIVE}
    said = tables.get(where, BY_HAND).get(kind, "Repeat the test at another amplitude.")
    return said.format(place=place or block, name=name or block.removeprefix("link."))


def fault_advice(kind: str, channel: str) -> str:
    """What to do about a fault of the recording or of the spec."""
    return FAULT.get(kind, "Check {channel}, and record again.").format(channel=channel)
