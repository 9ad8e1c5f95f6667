"""A test spread over two hosts, each a network namespace of this machine, joined by a cable."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from benchmarks.hosts import ADDRESSES, SCRIPTS, on

from rthm_analysis.recording import read_recording
from rthm_bringup.run.environment import Network
from rthm_core.spec import apply, spec_at, write_spec

pytestmark = [pytest.mark.graph, pytest.mark.usefixtures("nothing_left")]


@pytest.mark.parametrize("reach", [pytest.param("multicast", marks=pytest.mark.long), "peers"])
def test_plant_on_one_host_and_controller_on_another(
    hosts: tuple[str, str], environment: dict[str, str], network: Network, tmp_path: Path, reach: str
) -> None:
    here, there = ["--network"], ["--network"]
    if reach == "peers":
        here, there = ["--peers", ADDRESSES[1]], ["--peers", ADDRESSES[0]]
    del environment["ROS_AUTOMATIC_DISCOVERY_RANGE"]
    plant = on(hosts[0], [SCRIPTS / "plant", "paper", *here], environment)
    numerical = on(hosts[0], [SCRIPTS / "numerical", "paper", *here], environment)
    run = [sys.executable, "-m", "rthm_bringup", "run", "paper", "--external", "plant,numerical", *there]
    run += ["--duration", "2", "--out", tmp_path / "out", "--json", "-", "--wait", "120"]
    with plant, numerical, on(hosts[1], run, environment) as leader:
        told, complaints = leader.communicate(timeout=300)
        plant.terminate()
        numerical.terminate()
        said = [node.communicate(timeout=60) for node in (plant, numerical)]
    assert leader.returncode == 0, (told, complaints, said)
    assert "waiting for numerical, plant" in complaints
    recording = read_recording(json.loads(told)["bag"])
    assert len(recording.plant) == 2_000_000_000 // 1_200_000 + 1
    assert len(recording.links["tau3"]) > 100
    assert plant.returncode == numerical.returncode == 0, said


@pytest.mark.long
def test_loopback_with_the_plant_on_the_machines_computer(
    hosts: tuple[str, str], environment: dict[str, str], tmp_path: Path
) -> None:
    """A stage of docs/first_machine.md: the real controller, and a simulated plant elsewhere."""
    rig = apply(spec_at(SCRIPTS.parent / "examples" / "rig.yaml"), {"limits.stale": 0.5})
    file = tmp_path / "rig.yaml"
    file.write_text(write_spec(rig))
    run = [sys.executable, "-m", "rthm_bringup", "run", file, "--external", "plant", "--peers", ADDRESSES[1]]
    run += ["--duration", "5", "--out", tmp_path / "out", "--json", "-", "--wait", "120"]
    with (
        on(hosts[1], [SCRIPTS / "plant", file, "--peers", ADDRESSES[0]], environment) as plant,
        on(hosts[0], run, environment) as leader,
    ):
        told, complaints = leader.communicate(timeout=300)
        plant.terminate()
    assert leader.returncode == 0, (told, complaints)
    result = json.loads(told)
    assert (result["abort"], result["lost"], set(result["hosts"])) == (None, 0, {"plant"})
    assert abs(result["hosts"]["plant"]["offset"]) <= result["hosts"]["plant"]["uncertainty"] + 1e-5
    recording = read_recording(result["bag"])
    assert np.ptp(recording.plant.columns("position", ["a1"])) > 0.02
    assert len(recording.links["tau4"]) > 100
