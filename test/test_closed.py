"""Nobody takes part in a test who was not asked to: other hosts, other runs, other nodes."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from benchmarks.hosts import ADDRESSES, on

from rthm_analysis.recording import read_recording
from rthm_bringup.run.conductor_node import Conductor
from rthm_bringup.run.environment import PROFILES, RANGE, Network
from rthm_core.ros.reach import PEERS, VARIABLE

pytestmark = [pytest.mark.usefixtures("nothing_left")]
RUN = [sys.executable, "-m", "rthm_bringup", "run", "paper", "--json", "-"]
RIVAL = Path(__file__).parent / "programs" / "rival.py"
OURS = (PROFILES, RANGE, VARIABLE, PEERS, "SKIP_DEFAULT_XML_FILE")

PROFILE = """<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com"><participant profile_name="x" is_default_profile="true"><rtps>
<builtin><initialPeersList><locator><udpv4><address>{address}</address></udpv4></locator></initialPeersList>
</builtin></rtps></participant></profiles>"""


def plain(environment: dict[str, str], **more: str) -> dict[str, str]:
    """Environment of somebody who knows nothing of ours but the domain."""
    return {name: value for name, value in environment.items() if name not in OURS} | more


@pytest.mark.parametrize("way", ["peers", pytest.param("profile", marks=pytest.mark.long)])
def test_another_host_hears_nothing_and_is_not_heard_whatever_is_set_on_either(
    hosts: tuple[str, str], environment: dict[str, str], tmp_path: Path, way: str
) -> None:
    profile = tmp_path / "theirs.xml"
    profile.write_text(PROFILE.format(address=ADDRESSES[0]))
    theirs = {"peers": {PEERS: ADDRESSES[0], RANGE: "SUBNET"}, "profile": {PROFILES: str(profile)}}[way]
    opened = tmp_path / "ours.xml"
    opened.write_text(PROFILE.format(address=ADDRESSES[1]))
    ours = plain(environment, **{PEERS: ADDRESSES[1], RANGE: "SUBNET", PROFILES: str(opened)})
    rival = on(hosts[1], [sys.executable, RIVAL, "actuator/command", "18"], plain(environment, **theirs))
    with rival, on(hosts[0], [*RUN, "--duration", "3", "--out", tmp_path / "out"], ours) as run:
        told, complaints = run.communicate(timeout=300)
        heard, _ = rival.communicate(timeout=60)
    assert heard == "heard 0\n"
    assert "publishers" not in told, (told, complaints)
    commands = read_recording(json.loads(told)["bag"]).tables["actuator/command"]
    assert np.abs(commands.position).max() < 1.0


@pytest.mark.parametrize("topic", ["actuator/command", pytest.param("plant/state", marks=pytest.mark.long)])
def test_a_host_that_is_no_peer_is_never_used_and_ends_the_test_by_publishing(
    hosts: tuple[str, str], environment: dict[str, str], tmp_path: Path, topic: str
) -> None:
    theirs = plain(environment, **{PEERS: ADDRESSES[0], RANGE: "SUBNET"})
    options = ["--peers", "10.91.7.77", "--duration", "60", "--out", tmp_path / "out"]
    with on(hosts[0], [*RUN, *options], plain(environment)) as run:
        bag = tmp_path / "out" / "bag" / "bag_0.mcap"
        while run.poll() is None and not (bag.exists() and bag.stat().st_size > 200_000):
            time.sleep(0.1)
        with on(hosts[1], [sys.executable, RIVAL, topic, "30"], theirs) as rival:
            told, complaints = run.communicate(timeout=300)
            rival.terminate()
    assert run.returncode == 3, (told, complaints)
    abort = json.loads(told)["abort"]
    assert (abort["limit"], abort["value"], abort["allowed"]) == ("owner", 2, 1)
    assert f"{topic} has 2 publishers" in abort["words"]
    recording = read_recording(json.loads(told)["bag"])
    assert recording.duration < 50.0
    assert np.abs(recording.tables["actuator/command"].position).max() < 1.0
    assert np.abs(recording.plant.columns("position", ["a1"])).max() < 1.0


@pytest.mark.long
def test_a_second_publisher_on_this_host_ends_the_test(environment: dict[str, str], tmp_path: Path) -> None:
    with subprocess.Popen(
        [*RUN, "--duration", "60", "--out", tmp_path / "out"],
        env=environment,
        stdout=subprocess.PIPE,
        text=True,
    ) as run:
        bag = tmp_path / "out" / "bag" / "bag_0.mcap"
        while run.poll() is None and not (bag.exists() and bag.stat().st_size > 200_000):
            time.sleep(0.1)
        words = [sys.executable, RIVAL, "numerical/force_reference", "30"]
        with subprocess.Popen(words, env=environment, stdout=subprocess.DEVNULL) as rival:
            told, _ = run.communicate(timeout=300)
            rival.terminate()
    assert run.returncode == 3, told
    abort = json.loads(told)["abort"]
    assert abort["limit"] == "owner"
    # By the leader, who sees both on the graph, or by the controller, whose samples are out of step.
    assert re.match("numerical/force_reference has (2 publishers, |a second publisher: )", abort["words"])
    assert read_recording(json.loads(told)["bag"]).abort.limit == "owner"


def started(environment: dict[str, str], *options: str | Path) -> subprocess.Popen[str]:
    words = [*RUN, *map(str, options)]
    return subprocess.Popen(words, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def start(environment: dict[str, str], *options: str | Path) -> subprocess.Popen[str]:
    return started(environment, "--virtual", *options)


def test_a_second_run_is_refused_in_one_sentence_and_the_first_ends_undisturbed(
    environment: dict[str, str], tmp_path: Path, network: Network
) -> None:
    with start(environment, "--duration", "15", "--out", tmp_path / "first") as first:
        while first.poll() is None and not (tmp_path / "first" / "bag").exists():
            time.sleep(0.1)
        with start(environment, "--duration", "1", "--out", tmp_path / "second") as second:
            nothing, refusal = second.communicate(timeout=120)
        assert first.poll() is None
        told, complaints = first.communicate(timeout=600)
    assert (second.returncode, nothing) == (2, "")
    assert refusal.count("\n") == 1
    assert f"leads the test in domain {network.domain}, namespace /rthm" in refusal
    assert not (tmp_path / "second").exists()
    assert first.returncode == 0, (told, complaints)
    assert json.loads(told)["problems"] == []


def wait_for_node(name: str, network: Network) -> None:
    """Wait until a node is on the graph; a cold start takes a busy host many seconds."""
    with Conductor(lambda: None, network.domain, network.namespace) as conductor:
        deadline = time.monotonic() + 60.0
        while name not in {found for found, _ in conductor.nodes()}:
            assert time.monotonic() < deadline, conductor.nodes()
            time.sleep(0.05)


def test_nodes_of_somebody_else_are_noticed_before_anything_moves(
    environment: dict[str, str], tmp_path: Path, network: Network
) -> None:
    node = [sys.executable, "-m", "rthm_actuator.node", "--ros-args", "-p", "autostart:=false"]
    with subprocess.Popen(node, env=environment) as other:
        wait_for_node("actuator", network)
        with start(environment, "--duration", "1", "--out", tmp_path / "out") as run:
            _, refusal = run.communicate(timeout=120)
        assert other.poll() is None
        other.terminate()
    assert run.returncode == 2
    assert "Another test is in domain" in refusal
    assert "actuator" in refusal
    assert not (tmp_path / "out" / "bag").exists()


@pytest.mark.long
@pytest.mark.parametrize("mode", [["--virtual"], []], ids=["virtual", "real time"])
def test_two_runs_in_one_domain_succeed_in_namespaces_of_their_own(
    environment: dict[str, str], tmp_path: Path, mode: list[str]
) -> None:
    options = ("--duration", "3", *mode)
    runs = [started(environment, *options, "--namespace", name, "--out", tmp_path / name) for name in "ab"]
    told = [run.communicate(timeout=600) for run in runs]
    assert [run.returncode for run in runs] == [0, 0], told
    recordings = [read_recording(json.loads(out)["bag"]) for out, _ in told]
    assert [recording.namespace for recording in recordings] == ["/a", "/b"]
    if mode:
        np.testing.assert_array_equal(recordings[0].plant.position, recordings[1].plant.position)
    else:
        assert {len(recording.plant) for recording in recordings} == {3_000_000_000 // 1_200_000 + 1}


def test_a_node_whose_profile_cannot_be_read_does_not_start(
    environment: dict[str, str], tmp_path: Path
) -> None:
    broken = tmp_path / "broken.xml"
    broken.write_text("<profiles><participant>")
    node = [sys.executable, "-m", "rthm_plant_sim.node"]
    done = subprocess.run(
        node,
        env=environment | {PROFILES: str(broken)},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 2
    assert "its profile is not in force" in done.stderr
