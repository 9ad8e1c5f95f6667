"""Every shipped spec means the same to real rclpy and to us."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node

from rthm_core.spec import (
    read_spec,
    shipped_names,
    shipped_spec,
    shipped_text,
    spec_from_parameters,
    write_spec,
)

OF_EVERY_NODE = ("use_sim_time", "start_type_description_service")


@pytest.fixture(autouse=True)
def _alone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "178")
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path))


@contextmanager
def node_with(file: Path) -> Iterator[Node]:
    """Start a node as ``ros2 run ... --ros-args --params-file FILE`` does."""
    context = Context()
    rclpy.init(args=["--ros-args", "--params-file", str(file)], context=context)
    options: dict[str, Any] = {"enable_rosout": False, "start_parameter_services": False}
    node = Node(
        "plant",
        namespace="/rthm",
        context=context,
        automatically_declare_parameters_from_overrides=True,
        **options,
    )
    yield node
    node.destroy_node()
    rclpy.shutdown(context=context)


def parameters_by_rclpy(file: Path) -> dict[str, Any]:
    with node_with(file) as node:
        return {name: one.value for name, one in node.get_parameters_by_prefix("").items()}


@pytest.mark.parametrize("name", shipped_names())
def test_rclpy_and_we_read_a_shipped_spec_alike(name: str, tmp_path: Path) -> None:
    text = shipped_text(name)
    for content in (text, write_spec(read_spec(text))):
        file = tmp_path / "spec.yaml"
        file.write_text(content, encoding="utf-8")
        by_ros = spec_from_parameters(parameters_by_rclpy(file), besides=OF_EVERY_NODE)
        assert by_ros == read_spec(file) == shipped_spec(name)


def test_rclpy_and_we_read_everything_at_once_alike(tmp_path: Path) -> None:
    """Integers, exponents without a dot, and names that look like truth values."""
    text = shipped_text("transmission") + (
        "    load: {plant: {kind: multisine, rms: 1, low: 1e-1, high: 9, count: 3, seed: 2}}\n"
        "    noise: {position: 1e-4, force: 2, seed: 7}\n"
        "    uncertainty: {plant: {mass: 5e-2}, actuator: {stiffness: 1}}\n"
        "    limits: {command: 1, rate: 5.0}\n"
        '    effects: ["on", guide]\n'
        '    "on": {block: motor, kind: lag, actuator: a1, time_constant: 3e-3}\n'
        "    guide: {block: plant, kind: bouc_wen, alpha: 1, beta: 2, gamma: 3, n: 2}\n"
    )
    file = tmp_path / "spec.yaml"
    for content in (text, write_spec(read_spec(text))):
        file.write_text(content, encoding="utf-8")
        assert spec_from_parameters(parameters_by_rclpy(file), besides=OF_EVERY_NODE) == read_spec(text)


def test_the_paper_is_the_papers_test_with_its_table_corrected() -> None:
    spec = shipped_spec("paper")
    plant, numerical, interface, actuator, timing = spec.loop()
    assert (plant.mass, plant.damping, plant.stiffness) == ((1.2,), (0.05,), (12.0,))
    assert (plant.initial_position, plant.initial_velocity) == ((0.5,), (0.0,))
    assert (numerical.mass, numerical.damping, numerical.stiffness) == ((1.5,), (0.05,), (6.0,))
    assert (interface.stiffness, interface.damping, spec.k_tot) == ((6.0,), (0.1,), (40.0,))
    times = (0.0012, 0.012, 0.004, 0.0, 0.004, 0.008, 0.012, 0.010)
    assert tuple(value for _, value in timing.items()) == times
    assert (actuator.motor_poles, actuator.transmission, spec.effects, spec.limits) == (None, None, (), None)
    assert set(dict(spec.noise.items()).values()) == {0}


def test_the_corrected_table_gives_the_dampings_that_the_paper_names() -> None:
    """0.66 N s/m = k_tot (tau1' + tau4) and -0.22 N s/m = -k2 (tau2' + tau3 + tau4), as in its section V."""

    def dampings(name: str) -> tuple[float, float]:
        timing = shipped_spec(name).loop().timing
        first = timing.tau1 + timing.td1 / 2 + timing.td3 / 2
        second = timing.tau2 + timing.td1 / 2 + timing.td2 / 2
        return round(40.0 * (first + timing.tau4), 2), round(-6.0 * (second + timing.tau3 + timing.tau4), 2)

    assert dampings("paper") == (0.66, -0.22)
    assert dampings("paper_printed")[0] == 0.82
