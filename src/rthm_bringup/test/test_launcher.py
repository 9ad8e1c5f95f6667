"""The parts of a run that need no ROS: environment, domain, processes, what goes into the bag."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rthm_analysis.recording.writing import BagWriter
from rthm_bringup.run import interfaces, shared_memory
from rthm_bringup.run.domain import Claim, Leadership, wanted
from rthm_bringup.run.environment import CLOSED, PROFILES, RANGE, Network, without_parents_ros
from rthm_bringup.run.intake import Intake
from rthm_bringup.run.processes import Process, Processes
from rthm_core.errors import InputError
from rthm_core.ros.reach import PEERS, VARIABLE
from rthm_core.topics import JOINT_STATE, LOOP

STATE = "plant/state"


def test_a_child_gets_neither_the_guard_nor_the_libraries_of_its_parent() -> None:
    parent = {
        "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1",
        "LD_LIBRARY_PATH": "/venv/lib:/opt/cuda/lib",
        "HOME": "/root",
    }
    child = without_parents_ros(parent, wheels=True, prefix="/venv")
    assert child == {"LD_LIBRARY_PATH": "/opt/cuda/lib", "HOME": "/root"}


def test_beside_wheels_a_sourced_ros_is_left_out() -> None:
    parent = {
        "AMENT_PREFIX_PATH": "/ws/install:/opt/ros/jazzy",
        "ROS_DISTRO": "jazzy",
        "LD_LIBRARY_PATH": "/opt/ros/jazzy/lib",
        "PYTHONPATH": "/ws/install/lib/python:/mine",
    }
    assert without_parents_ros(parent, wheels=True, prefix="/venv") == {"PYTHONPATH": "/mine"}
    assert without_parents_ros(parent, wheels=False) == parent


def test_nodes_are_visible_on_this_host_only_unless_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(RANGE, "SUBNET")
    monkeypatch.setenv(PEERS, "10.0.0.9")
    alone = Network(7).variables()
    assert (alone["ROS_DOMAIN_ID"], alone[VARIABLE], alone[PEERS]) == ("7", "host", "")
    assert alone[PROFILES] == str(CLOSED)
    assert Network(7, open=True).variables()[RANGE] == "SUBNET"
    named = Network(7, peers=("a", "b")).variables()
    assert (named[PEERS], named[VARIABLE], named[RANGE]) == ("a;b", "peers", "LOCALHOST")


def test_settings_of_the_middleware_are_the_users_on_an_open_network_only(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv(PROFILES, raising=False)
    assert Path(Network(7, open=True).variables()[PROFILES]).is_file()
    monkeypatch.setenv(PROFILES, "my_own.xml")
    assert Network(7, open=True).variables()[PROFILES] == "my_own.xml"
    monkeypatch.setenv(PROFILES, str(CLOSED))  # as within another run
    assert Network(7, open=True).variables()[PROFILES] != str(CLOSED)
    monkeypatch.setenv(PROFILES, "my_own.xml")
    for network in (Network(7), Network(7, peers=("10.0.0.1",))):
        assert network.variables()[PROFILES] != "my_own.xml"


@pytest.mark.parametrize("name", ["rig", "/", "/rig 1", "/1", "/rig/", "/a__b"])
def test_a_namespace_that_ros_does_not_know_is_refused(name: str) -> None:
    with pytest.raises(InputError, match="choose another one"):
        Network(7, namespace=name)


def test_one_run_leads_in_a_namespace_and_others_beside_it() -> None:
    first, beside = Leadership(7, "/rthm"), Leadership(7, "/b")
    with pytest.raises(InputError, match="leads the test in domain 7, namespace /rthm"):
        Leadership(7, "/rthm")
    first.release()
    Leadership(7, "/rthm").release()
    beside.release()


def test_other_hosts_are_looked_for_once_a_network_is_up() -> None:
    found: list[list[str]] = [[], [], ["10.0.0.1"]]
    said: list[str] = []
    interfaces.wait_for_one(said.append, found=lambda: found.pop(0))
    assert found == []
    assert said == ["waiting for a network of this host to come up"]
    with pytest.raises(InputError, match="leave --network and --peers out"):
        interfaces.wait_for_one(said.append, seconds=0.0, found=list)


def test_loopback_is_no_network() -> None:
    assert not any(address.startswith("127.") for address in interfaces.addresses())


def test_two_runs_get_different_domains() -> None:
    claims = [Claim() for _ in range(5)]
    assert len({claim.domain for claim in claims}) == 5
    for claim in claims:
        claim.release()


def test_a_domain_in_which_somebody_listens_is_not_taken() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as node:
        node.bind(("", 7410 + 250 * 33))
        claims = [Claim() for _ in range(30)]
        assert 33 not in {claim.domain for claim in claims}
        for claim in claims:
            claim.release()


@pytest.mark.parametrize(
    ("option", "variable", "fixed", "domain"),
    [(5, "7", False, 5), (None, "7", False, 7), (None, "", True, 0), (None, "", False, None)],
)
def test_the_option_precedes_the_variable(
    option: int | None, variable: str, fixed: bool, domain: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", variable)
    assert wanted(option, fixed) == domain


def test_a_domain_that_is_no_number_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "seven")
    with pytest.raises(InputError, match="ROS_DOMAIN_ID is 'seven'"):
        wanted(None, False)


SLEEP = "import time; print('awake', flush=True); time.sleep(60)"
STUBBORN = "import signal; signal.signal(signal.SIGTERM, signal.SIG_IGN); " + SLEEP


def waiting(tmp_path: Path, code: str) -> Process:
    process = Process("sleeper", [sys.executable, "-c", code], tmp_path / "sleeper.log")
    process.start(dict(os.environ))
    while process.last_words() != "awake":
        time.sleep(0.02)
    return process


@pytest.mark.parametrize("code", [SLEEP, STUBBORN], ids=["obedient", "stubborn"])
def test_no_process_outlives_the_block(tmp_path: Path, code: str) -> None:
    with Processes() as processes:
        process = Process("sleeper", [sys.executable, "-c", code], tmp_path / "log")
        processes.start(process, dict(os.environ))
        while process.last_words() != "awake":
            time.sleep(0.02)
        assert process.alive
        assert processes.dead() == []
    assert not process.alive


def test_a_process_says_how_it_ended(tmp_path: Path) -> None:
    process = waiting(tmp_path, SLEEP)
    process.send(signal.SIGKILL)
    while process.alive:
        time.sleep(0.02)
    assert process.fate() == "sleeper was killed by SIGKILL: awake"


def test_a_process_ends_when_its_launcher_is_killed(tmp_path: Path) -> None:
    launcher = (
        "import os, sys, time; from pathlib import Path; from rthm_bringup.run.processes import Process\n"
        f"p = Process('s', [sys.executable, '-c', {SLEEP!r}], Path({str(tmp_path / 'log')!r}))\n"
        "p.start(dict(os.environ)); print(p.pid, flush=True); time.sleep(60)"
    )
    with subprocess.Popen([sys.executable, "-c", launcher], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout
        child = int(parent.stdout.readline())
        parent.kill()
    deadline = time.monotonic() + 20
    while Path(f"/proc/{child}/status").exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    assert not Path(f"/proc/{child}/status").exists()


def test_shared_memory_whose_owner_lives_is_not_abandoned() -> None:
    name = f"fastrtps_{os.getpid():016x}"
    segment, lock = (shared_memory.FOLDER / (name + end) for end in ("", "_el"))
    segment.touch()
    code = f"import fcntl, time; lock = open({str(lock)!r}, 'w'); fcntl.flock(lock, fcntl.LOCK_EX); "
    code += "print(flush=True); time.sleep(60)"
    try:
        with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE) as owner:
            assert owner.stdout
            owner.stdout.readline()
            left = shared_memory.abandoned()
            owner.kill()
        assert name not in left
        assert {segment.name, lock.name} <= shared_memory.abandoned()
    finally:
        segment.unlink()
        lock.unlink(missing_ok=True)


def message(stamp: int) -> bytes:
    seconds, nanoseconds = divmod(stamp, 10**9)
    return b"\x00\x01\x00\x00" + seconds.to_bytes(4, "little") + nanoseconds.to_bytes(4, "little")


def told(number: int | None) -> dict:
    return {"received_timestamp": 9, "source_timestamp": 8, "publication_sequence_number": number}


@pytest.fixture
def intake(tmp_path: Path) -> Intake:
    return Intake(BagWriter(tmp_path / "bag"), {topic: f"/rthm/{topic}" for topic in (*LOOP, "energy")})


def test_no_sample_of_the_loop_precedes_the_start_or_follows_the_end(intake: Intake) -> None:
    intake.open(100, 200)
    for number, stamp in enumerate([99, 100, 150, 200, 201], start=1):
        intake.take(STATE, JOINT_STATE, message(stamp), told(number))
    intake.writer.close()
    assert intake.writer.counts == {"/rthm/plant/state": 3}


@given(st.sets(st.integers(2, 60)), st.integers(0, 62), st.integers(0, 62))
def test_every_gap_in_the_numbers_of_a_publisher_is_counted_within_the_test(
    missing: set[int], one: int, other: int
) -> None:
    import tempfile

    begin, end = 1000 * min(one, other), 1000 * max(one, other)
    with tempfile.TemporaryDirectory() as folder, BagWriter(Path(folder) / "bag") as writer:
        intake = Intake(writer, {STATE: "/rthm/plant/state"})
        for number in range(1, 62):
            if number == 20:
                intake.open(begin, end)
            if number not in missing:
                intake.take(STATE, JOINT_STATE, message(1000 * number), told(number))
        seen_late = range(max([n for n in range(1, 20) if n not in missing]) + 1, 62)
        assert intake.lost == sum(begin <= 1000 * number <= end for number in missing if number in seen_late)


def test_a_middleware_that_does_not_number_its_messages_loses_none(intake: Intake) -> None:
    intake.open(0, None)
    for number in (2**64 - 1, None):
        intake.take(STATE, JOINT_STATE, message(1), told(number))
    intake.writer.close()
    assert intake.lost == 0


def test_samples_of_the_plant_that_come_twice_are_counted_within_the_test(intake: Intake) -> None:
    intake.open(2, None)
    for number, stamp in enumerate([1, 1, 2, 3, 3, 3, 4], start=1):
        intake.take(STATE, JOINT_STATE, message(stamp), told(number))
    intake.writer.close()
    assert (intake.twice, intake.lost) == (2, 0)


def test_a_recording_is_complete_when_no_further_sample_fits(intake: Intake) -> None:
    intake.open(0, 1000)
    intake.take(STATE, JOINT_STATE, message(880), told(1))
    assert intake.behind({STATE: 120})[0].startswith("plant/state ends")
    assert intake.behind({STATE: 121}) == []
    intake.writer.close()


def test_in_simulated_time_who_watches_is_received_with_the_newest_sample(intake: Intake) -> None:
    intake.virtual = True
    intake.open(0, None)
    intake.take(STATE, JOINT_STATE, message(700), told(1))
    intake.take("energy", JOINT_STATE, message(10**18), told(1))
    intake.writer.close()
    text = (intake.writer.folder / "metadata.yaml").read_text()
    assert "nanoseconds_since_epoch: 700" in text
    assert "duration:\n    nanoseconds: 0" in text
