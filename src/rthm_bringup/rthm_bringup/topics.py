"""Topics of a hybrid test and their types; names are relative to its namespace but for ``/diagnostics``."""

from __future__ import annotations

NAMESPACE = "/rthm"
SPEC = "spec"
STRING = "std_msgs/msg/String"
JOINT_STATE = "sensor_msgs/msg/JointState"
TIME_REFERENCE = "sensor_msgs/msg/TimeReference"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"

PLANT_STATE = "plant/state"
LOOP = {
    PLANT_STATE: JOINT_STATE,
    "numerical/state": JOINT_STATE,
    "numerical/force_reference": JOINT_STATE,
    "actuator/command": JOINT_STATE,
    "links/tau1": TIME_REFERENCE,
    "links/tau2": TIME_REFERENCE,
    "links/tau3": TIME_REFERENCE,
    "links/tau4": TIME_REFERENCE,
}
"""What makes up the test: stamped within it, each from one publisher."""

COMMAND, DRY, CLOCKS = "actuator/command", "actuator/command_dry", "clocks"
BESIDE = {
    "energy": JOINT_STATE,
    CLOCKS: JOINT_STATE,
    "/diagnostics": DIAGNOSTICS,
    "events": STRING,
    DRY: JOINT_STATE,
}
"""What is said about the test."""
