"""Parts that share a process: as a command line, as a process, and where that cannot be."""

from __future__ import annotations

from pathlib import Path

import pytest

from rthm_bringup.run import roles
from rthm_bringup.run.environment import Network
from rthm_bringup.run.plan import Plan
from rthm_bringup.run.processes import JOINT, Process
from rthm_core.errors import InputError
from rthm_core.spec import shipped_spec


def test_the_command_line_names_the_package_of_each_node() -> None:
    words = roles.command(roles.COMPOSED, Path("spec.yaml"), {"priority": 3}, "/rig")
    assert words[2:5] == ["rthm_bringup.run.composed", "rthm_numerical.node", "rthm_actuator.node"]
    assert words[5:] == ["--ros-args", "-r", "__ns:=/rig", "--params-file", "spec.yaml", "-p", "priority:=3"]


def test_a_process_knows_all_its_nodes() -> None:
    assert Process(JOINT.join(roles.COMPOSED), [], Path("x.log")).nodes == {"numerical", "actuator"}
    assert Process("plant", [], Path("x.log")).nodes == {"plant"}


@pytest.mark.parametrize("other", [{"virtual": True}, {"external": frozenset({"numerical"})}])
def test_parts_that_run_otherwise_are_not_composed(other: dict) -> None:
    with pytest.raises(InputError, match="--compose works only in real time with both parts on this host"):
        Plan(shipped_spec(), Path("out"), 1.0, Network(0), compose=True, **other)
