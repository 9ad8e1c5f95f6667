"""A test spread over two hosts, each a network namespace of this machine, joined by a cable."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from rthm_analysis.recording import read_recording
from rthm_bringup.run.environment import Network

pytestmark = [pytest.mark.graph, pytest.mark.usefixtures("nothing_left")]
SCRIPTS = Path(__file__).parents[1] / "scripts"
ADDRESSES = ("10.91.7.1", "10.91.7.2")


def ip(words: str) -> None:
    subprocess.run(["ip", *words.split()], check=True, capture_output=True)


@pytest.fixture
def hosts() -> Iterator[tuple[str, str]]:
    """Names of two network namespaces that reach each other."""
    if os.geteuid() != 0 or shutil.which("ip") is None:
        pytest.skip("two hosts on one machine need root and the program ip")
    subprocess.run([SCRIPTS / "rthm", "--help"], check=True, capture_output=True)  # no registry in there
    names = tuple(f"rthm{os.getpid()}{side}" for side in "ab")
    cables = [f"{name[-8:]}c" for name in names]
    try:
        for name in names:
            ip(f"netns add {name}")
        ip(f"link add {cables[0]} netns {names[0]} type veth peer name {cables[1]} netns {names[1]}")
        for name, cable, address in zip(names, cables, ADDRESSES, strict=True):
            ip(f"-n {name} address add {address}/24 dev {cable}")
            ip(f"-n {name} link set {cable} up")
            ip(f"-n {name} link set lo up")
    except subprocess.CalledProcessError as error:
        pytest.skip(f"this machine has no network namespaces: {error.stderr.decode().strip()}")
    yield names
    for name in names:
        subprocess.run(["ip", "netns", "delete", name], check=False, capture_output=True)


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


def on(host: str, words: list, environment: dict[str, str]) -> subprocess.Popen[str]:
    """Start a program on a host."""
    return subprocess.Popen(
        ["ip", "netns", "exec", host, *map(str, words)],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
