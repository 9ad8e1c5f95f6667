"""A test spread over two hosts, each a network namespace of this machine, joined by a cable."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest
from hosts import ADDRESSES, SCRIPTS, on

from rthm_analysis.recording import read_recording
from rthm_bringup.run.environment import Network

pytestmark = [pytest.mark.graph, pytest.mark.usefixtures("nothing_left")]


@pytest.mark.parametrize("reach", ["multicast", "peers"])
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
