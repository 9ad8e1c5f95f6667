"""The launch file, as far as it can be looked at without launch."""

from __future__ import annotations

import ast
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml

SOURCES = Path(__file__).parents[1] / "src"
LAUNCH = SOURCES / "rthm_bringup" / "launch" / "hybrid_test.launch.py"


def constant(name: str) -> dict:
    """Value of a constant of the launch file."""
    for node in ast.parse(LAUNCH.read_text()).body:
        if isinstance(node, ast.Assign) and node.targets[0].id == name:
            return ast.literal_eval(node.value)
    raise AssertionError(f"{name} is not there")


def function(name: str) -> Callable[[Any, Any], None]:
    """Function of the launch file, without what it imports."""
    body = [node for node in ast.parse(LAUNCH.read_text()).body if getattr(node, "name", "") == name]
    space: dict[str, Any] = {"ProcessExited": object, "LaunchContext": object}
    exec(compile(ast.Module(body, []), str(LAUNCH), "exec"), space)
    found: Callable[[Any, Any], None] = space[name]
    return found


def test_a_node_that_ends_before_the_test_ends_the_launch_and_afterwards_it_may_end() -> None:
    ended, event = function("_ended"), SimpleNamespace(process_name="recorder-1", returncode=-9)
    with pytest.raises(RuntimeError, match="recorder-1 ended with status -9 before the test did"):
        ended(event, SimpleNamespace(is_shutdown=False))
    ended(event, SimpleNamespace(is_shutdown=True))


def test_the_launch_file_compiles() -> None:
    compile(LAUNCH.read_text(), str(LAUNCH), "exec")


@pytest.mark.parametrize("name", ["plant", "numerical", "actuator", "analysis", "recorder"])
def test_the_launch_file_starts_programs_that_are_installed(name: str) -> None:
    package, program = constant("PROGRAMS")[name]
    folder = SOURCES / package
    scripts = (folder / "setup.py").read_text()
    assert (folder / "programs" / program).is_file() or f'"{program} = {package}.node:main"' in scripts


def test_the_launch_file_generates_its_description_where_launch_is_installed() -> None:
    pytest.importorskip("launch_ros", reason="launch comes with ROS 2 itself, not with its wheels")
    space: dict = {"__name__": "hybrid_test"}
    exec(compile(LAUNCH.read_text(), str(LAUNCH), "exec"), space)
    assert len(space["generate_launch_description"]().entities) == 10


def test_the_configuration_for_launch_has_the_defaults_of_the_nodes() -> None:
    from rthm_core.ros.parameters import OWN

    given = yaml.safe_load((SOURCES / "rthm_bringup/config/nodes.yaml").read_text())["/**"]["ros__parameters"]
    assert given == {name: OWN[name].value for name in given}
