"""Parameters of a node: the spec's, and those of the node itself.

A node takes the spec from whatever parameters it is given (a spec is a ROS 2 parameter file); without any
it takes the paper's. Files that ``effects_from`` names are executed. Every entry is declared with its
description, unit and range. Types are dynamic, as
``mass: [1]`` has to be as good as ``mass: [1.0]``; the spec checks every value when the node is configured.
"""

from __future__ import annotations

import sys
from collections.abc import Collection
from typing import Any, NamedTuple

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node

from rthm_core.errors import InputError
from rthm_core.ros.qos import DEPTH
from rthm_core.spec import Parameter, Spec, parameters, shipped_spec, spec_with_own_effects


class Own(NamedTuple):
    """A parameter of the node itself: default value, description, and its range if it is a number."""

    value: Any
    description: str
    lowest: float = 0
    highest: float = 0


OWN = {
    "start_time": Own(
        0,
        "instant of the start of the test [ns]; 0: the plant takes a full second, 1 s to 2 s after its "
        "activation, the others the stamp of its first state",
        0,
        2**63 - 1,
    ),
    "duration": Own(0.0, "length of the test [s]; 0: until the node is deactivated", 0.0, 1e9),
    "virtual": Own(False, "simulated time in windows that a coordinator grants"),
    "autostart": Own(False, "configure at once, and activate as soon as all peers are there"),
    "priority": Own(50, "real-time priority (SCHED_FIFO) that is asked for; 0: none", 0, 99),
    "lock_memory": Own(True, "keep all memory of the process in RAM"),
    "spin_margin": Own(
        100e-6, "time before a deadline in which the clock is watched without sleep [s]", 0.0, 0.01
    ),
    "depth": Own(DEPTH, "samples of a topic that are kept for a slow receiver", 10, 100000),
    "reliable": Own(True, "reliable delivery; false: best effort, for networks that lose messages"),
}
"""Parameters of every node, beside the spec."""


def declare_own(node: Node) -> None:
    """Declare the parameters of the node itself."""
    for name, own in OWN.items():
        descriptor = ParameterDescriptor(description=own.description)
        if isinstance(own.value, float):
            descriptor.floating_point_range = [
                FloatingPointRange(from_value=own.lowest, to_value=own.highest)
            ]
        elif not isinstance(own.value, bool):
            descriptor.integer_range = [IntegerRange(from_value=int(own.lowest), to_value=int(own.highest))]
        node.declare_parameter(name, own.value, descriptor)


def declare_spec(node: Node, besides: Collection[str]) -> None:
    """Declare the entries of the spec that the node was given, or of the paper's.

    What was given but is no spec is declared as it is, so that it can be looked at and put right; `spec_of`
    then says what is wrong.
    """
    given = {name: p.value for name, p in node._parameter_overrides.items() if name not in besides}
    try:
        spec = spec_with_own_effects(given) if given else shipped_spec("paper")
    except InputError:
        for name, value in given.items():
            node.declare_parameter(
                name, value, ParameterDescriptor(dynamic_typing=True), ignore_override=True
            )
        return
    for entry in parameters(spec):
        node.declare_parameter(entry.name, entry.value, _descriptor(entry), ignore_override=True)


def spec_of(node: Node, besides: Collection[str]) -> Spec:
    """Return the spec that the node's parameters describe now.

    Raises
    ------
    InputError
        If they describe none.
    """
    return spec_with_own_effects({name: p.value for name, p in node._parameters.items()}, besides)


def _descriptor(entry: Parameter) -> ParameterDescriptor:
    unit = f" [{entry.unit}]" if entry.unit else ""
    descriptor = ParameterDescriptor(
        description=f"{entry.description}{unit}", additional_constraints=entry.allowed, dynamic_typing=True
    )
    if entry.type == "double" and (entry.minimum is not None or entry.maximum is not None):
        lowest = -sys.float_info.max if entry.minimum is None else entry.minimum
        highest = sys.float_info.max if entry.maximum is None else entry.maximum
        descriptor.floating_point_range = [FloatingPointRange(from_value=lowest, to_value=highest)]
    return descriptor
