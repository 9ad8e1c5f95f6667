"""Topics of a hybrid test and their types; names are relative to its namespace but for ``/diagnostics``."""

from __future__ import annotations

NAMESPACE = "/rthm"

JOINT_STATE = "sensor_msgs/msg/JointState"
TIME_REFERENCE = "sensor_msgs/msg/TimeReference"
STRING = "std_msgs/msg/String"
DIAGNOSTIC_ARRAY = "diagnostic_msgs/msg/DiagnosticArray"

PLANT_STATE = "plant/state"
NUMERICAL_STATE = "numerical/state"
FORCE_REFERENCE = "numerical/force_reference"
COMMAND, DRY_COMMAND = "actuator/command", "actuator/command_dry"
INPUTS = "plant/inputs"
"""What is recorded of a component beside motion and force, such as a voltage: efforts in their own units."""
ACCELERATION = "plant/acceleration"
"""Measured accelerations of the plant's dofs, m/s^2, as efforts: JointState has no field for them."""
LINKS = ("tau1", "tau2", "tau3", "tau4")
"""Delays of the loop."""


def link_topic(name: str) -> str:
    """Topic that tells when the samples of a link came."""
    return f"links/{name}"


LOOP = {
    PLANT_STATE: JOINT_STATE,
    NUMERICAL_STATE: JOINT_STATE,
    FORCE_REFERENCE: JOINT_STATE,
    COMMAND: JOINT_STATE,
    **{link_topic(name): TIME_REFERENCE for name in LINKS},
}
"""What makes up the test: stamped within it, each from one publisher."""

SPEC, ENERGY, CLOCKS, EVENTS, DIAGNOSTICS = "spec", "energy", "clocks", "events", "/diagnostics"
BESIDE = {
    ACCELERATION: JOINT_STATE,
    ENERGY: JOINT_STATE,
    CLOCKS: JOINT_STATE,
    DIAGNOSTICS: DIAGNOSTIC_ARRAY,
    EVENTS: STRING,
    DRY_COMMAND: JOINT_STATE,
}
"""What is measured beside the loop, or said about the test."""
