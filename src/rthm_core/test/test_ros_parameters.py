from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter

from rthm_core.errors import InputError
from rthm_core.ros.parameters import OWN, declare_own, declare_spec, spec_of
from rthm_core.spec import parameters, shipped_names, shipped_spec


@pytest.fixture
def context(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> Iterator[rclpy.Context]:
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF")
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path))
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=1 + os.getpid() % 100)
    yield context
    rclpy.try_shutdown(context=context)


def declared(context: rclpy.Context, given: dict[str, Any]) -> tuple[Node, set[str]]:
    overrides = [Parameter(name, value=value) for name, value in given.items()]
    node = Node("n", context=context, parameter_overrides=overrides, allow_undeclared_parameters=True)
    besides = {*node._parameters, *OWN}
    declare_own(node)
    declare_spec(node, besides)
    return node, besides


@pytest.mark.parametrize("name", shipped_names())
def test_the_parameters_of_a_node_give_back_its_spec(context: rclpy.Context, name: str) -> None:
    spec = shipped_spec(name)
    node, besides = declared(context, {entry.name: entry.value for entry in parameters(spec)})
    assert spec_of(node, besides) == spec
    node.destroy_node()


def test_a_node_without_a_spec_takes_the_papers(context: rclpy.Context) -> None:
    node, besides = declared(context, {"duration": 3.0})
    assert spec_of(node, besides) == shipped_spec("paper")
    assert node.get_parameter("duration").value == 3.0
    node.destroy_node()


def test_every_parameter_says_what_it_is_in_which_unit_and_range(context: rclpy.Context) -> None:
    node, besides = declared(context, {})
    for name in node._parameters:
        assert name in besides - set(OWN) or node.describe_parameter(name).description, name
    tau1 = node.describe_parameter("timing.tau1")
    assert tau1.description == "delay of the plant's state to the controller [s]"
    assert tau1.floating_point_range[0].from_value == 0.0
    assert node.describe_parameter("priority").integer_range[0].to_value == 99
    node.destroy_node()


def test_a_value_out_of_range_is_refused_when_it_is_set(context: rclpy.Context) -> None:
    node, _ = declared(context, {})
    (result,) = node.set_parameters([Parameter("timing.tau1", value=-0.004)])
    assert not result.successful
    assert "timing.tau1" in result.reason
    node.destroy_node()


def test_integers_are_as_good_as_floats(context: rclpy.Context) -> None:
    node, besides = declared(context, {})
    assert all(result.successful for result in node.set_parameters([Parameter("plant.mass", value=[2])]))
    assert spec_of(node, besides).plant.mass == (2.0,)
    node.destroy_node()


def test_what_is_no_spec_can_be_looked_at_and_put_right(context: rclpy.Context) -> None:
    good = {entry.name: entry.value for entry in parameters(shipped_spec())}
    node, besides = declared(context, good | {"plant.mass": [-1.2]})
    assert list(node.get_parameter("plant.mass").value) == [-1.2]
    with pytest.raises(InputError, match=r"plant\.mass"):
        spec_of(node, besides)
    node.set_parameters([Parameter("plant.mass", value=[1.2])])
    assert spec_of(node, besides) == shipped_spec()
    node.destroy_node()
