"""A driver of somebody else stands at 0.1 m: nothing jumps, and whatever fails ends the test as an abort."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from benchmarks.faults.attempt import attempt
from benchmarks.faults.catalogue import FAULTS, Fault
from benchmarks.faults.laboratory import RATE, STANDS, Laboratory
from benchmarks.faults.measure import largest_step
from benchmarks.faults.ways import Disk
from benchmarks.rigs import RTHM, Told, process

from rthm_analysis.recording import Recording, read_recording
from rthm_analysis.recording.files import read_raw
from rthm_bringup.run.environment import Network
from rthm_core.clock import NS
from rthm_core.spec import shipped_spec

pytestmark = [pytest.mark.graph, pytest.mark.usefixtures("nothing_left")]
OFTEN = ("nan", "operator-service", "operator-heartbeat")
"""Faults that are made in every run of the tests; the others take long."""


@pytest.fixture
def laboratory(environment: dict[str, str], network: Network, tmp_path: Path) -> Laboratory:
    return Laboratory(environment, tmp_path)


@pytest.mark.parametrize(
    "fault",
    [
        pytest.param(fault, id=fault.name, marks=() if fault.name in OFTEN else pytest.mark.long)
        for fault in FAULTS
        if not fault.way.hosts and not isinstance(fault.way, Disk)
    ],
)
def test_a_fault_of_a_running_test_ends_as_the_catalogue_says(laboratory: Laboratory, fault: Fault) -> None:
    outcome = attempt(fault, laboratory)
    assert outcome.complaints == (), outcome


@pytest.mark.long
@pytest.mark.parametrize("fault", [pytest.param(one, id=one.name) for one in FAULTS if one.way.hosts])
def test_a_cable_that_is_pulled_ends_the_test(
    hosts: tuple[str, str], environment: dict[str, str], tmp_path: Path, fault: Fault
) -> None:
    outcome = attempt(fault, Laboratory(environment, tmp_path, hosts[0]), hosts)
    assert outcome.complaints == (), outcome


@pytest.mark.long
@pytest.mark.skipif(os.geteuid() != 0, reason="a disk of its own needs root")
@pytest.mark.parametrize("fault", [one for one in FAULTS if isinstance(one.way, Disk)])
def test_a_full_disk_ends_the_test(laboratory: Laboratory, fault: Fault) -> None:
    outcome = attempt(fault, laboratory)
    assert outcome.complaints == (), outcome


def assert_aborted(told: Told, limit: str) -> None:
    """The abort is in the status, the JSON, the first line and the page."""
    assert told.status == 3, told.out
    abort = told.json["abort"]
    assert abort["limit"] == limit, told.out
    assert told.out.splitlines()[0] == f"Aborted at {abort['at']:.3f} s: {abort['words']}"
    assert told.page.index("Aborted at") < told.page.index("<h1>")


def assert_no_jump(recording: Recording) -> None:
    """Every step of the command is within the rate, the first one is from where the motor stands."""
    assert largest_step(recording, RATE) <= 1.0
    u_d = recording.tables["actuator/command"].columns("position", ["a1"])[:, 0]
    assert np.all(np.abs(np.diff(np.append(STANDS, u_d))) <= RATE * 0.004 + 1e-12)


def test_a_real_machine_is_not_moved_without_limits(laboratory: Laboratory) -> None:
    command = [*RTHM, "run", "paper", "--plant", "external", "--out", str(laboratory.folder / "out")]
    done = subprocess.run(command, env=laboratory.environment, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "limits.command, rate, force, stale and ramp are missing" in done.stderr


def test_a_rig_that_is_not_where_the_spec_begins_is_refused_with_figures(laboratory: Laboratory) -> None:
    told = laboratory.run(laboratory.spec(begins=0.5, start=None), "--duration", "2")
    assert told.status == 1
    assert "reads 0.1 m and the spec begins at 0.5 m, 0.4 m away" in told.json["problems"][0]
    assert "limits.start allows 0.01 m" in told.json["problems"][0]
    assert told.json["abort"] is None


def test_a_test_that_is_predicted_beyond_its_limits_is_refused_before_anything_moves(
    laboratory: Laboratory,
) -> None:
    told = laboratory.run(laboratory.spec(rate=0.2), "--duration", "2")
    assert told.status == 1
    assert told.json["abort"] is None
    refusal = told.json["problems"][0]
    assert "predicted to go beyond its limits: rate 0.4" in refusal
    assert "of 0.2 m/s" in refusal and "--amplitude 0.4" in refusal
    assert told.json["predicted"]["rate"]["value"] > told.json["predicted"]["rate"]["allowed"] == 0.2
    log = laboratory.driver_log()
    assert log is not None
    assert [u for _, u in log.moves] == [STANDS]


def test_commands_begin_where_the_motor_stands(laboratory: Laboratory) -> None:
    told = laboratory.run(laboratory.spec(), "--duration", "2")
    assert told.status == 0, told.out
    assert told.json["abort"] is None
    assert_no_jump(told.recording)
    u_d = told.recording.tables["actuator/command"].columns("position", ["a1"])[:, 0]
    assert u_d[0] == u_d[-1] == STANDS
    assert np.ptp(u_d) > 0.02
    armed = next(event for event in told.recording.events if event["event"] == "armed")
    assert armed["motor"] == [STANDS]


def test_a_dry_run_computes_commands_and_sends_none(laboratory: Laboratory) -> None:
    told = laboratory.run(laboratory.spec(), "--duration", "2", "--dry-run")
    assert told.status == 0, told.out
    recording = told.recording
    assert "actuator/command" not in recording.tables
    assert np.all(recording.plant.columns("position", ["a1"]) == STANDS)
    assert len(read_raw(told.json["bag"]).topics["/rthm/actuator/command_dry"]) > 400


@pytest.mark.long
def test_the_key_a_aborts_a_test(laboratory: Laboratory) -> None:
    hand, keyboard = os.openpty()
    options = ("--plant", "external", "--duration", "30")
    with (
        laboratory.driver(),
        laboratory.begun(laboratory.spec(), *options, keyboard=keyboard) as (run, ended),
    ):
        laboratory.wait_until_it_moves(run)
        os.write(hand, b"a")
        told = ended()
    os.close(hand)
    os.close(keyboard)
    assert (told.status, told.json["abort"]["limit"]) == (3, "operator"), told.out
    assert told.out.splitlines()[0] == f"Aborted at {told.json['abort']['at']:.3f} s: the key a was pressed"
    assert_no_jump(told.recording)


@pytest.mark.long
def test_a_controller_that_stalled_does_not_catch_up(laboratory: Laboratory) -> None:
    options = ("--plant", "external", "--duration", "4")
    with laboratory.driver(), laboratory.begun(laboratory.spec(stale=1.0), *options) as (run, ended):
        laboratory.wait_until_it_moves(run)
        controller = process(run, "rthm_actuator")
        os.kill(controller, signal.SIGSTOP)
        time.sleep(0.2)
        os.kill(controller, signal.SIGCONT)
        told = ended()
    assert told.status == 0, told.out
    assert_no_jump(told.recording)
    commands = told.recording.tables["actuator/command"]
    stall = int(np.argmax(np.diff(commands.stamp_ns)))
    assert told.json["clocks"]["td3"]["missed"] >= 40
    assert commands.stamp_ns[stall + 1] - commands.stamp_ns[stall] > 0.15 * NS
    sent = commands.received_ns[stall + 1 :] - commands.received_ns[stall + 1]
    assert np.count_nonzero(sent < 0.08 * NS) <= 2 * 80 // 4


def test_a_killed_leader_leaves_motors_at_rest_and_the_way_there_recorded(
    laboratory: Laboratory, own_processes: Callable[[], list[str]]
) -> None:
    options = ("--plant", "external", "--duration", "60")
    with laboratory.driver(), laboratory.begun(laboratory.spec(), *options) as (run, _):
        laboratory.wait_until_it_moves(run)
        run.kill()
        deadline = time.monotonic() + 30
        while own_processes() and time.monotonic() < deadline:
            time.sleep(0.1)
    recording = read_recording(laboratory.folder / "out" / "bag")
    assert_no_jump(recording)
    u_d = recording.tables["actuator/command"].columns("position", ["a1"])[:, 0]
    assert u_d[-1] == STANDS
    assert abs(u_d[-60] - STANDS) > 1e-4  # it was on its way


def in_simulated_time(laboratory: Laboratory, begins: float = 0.5, **limits: Any) -> Told:
    """A test of the simulated rig, fast and the same each time."""
    spec = laboratory.spec(begins=begins, stale=0.05, **limits)
    with laboratory.begun(spec, "--virtual", "--duration", "10") as (_, ended):
        return ended()


@pytest.mark.long
def test_a_test_in_simulated_time_is_aborted_as_well(laboratory: Laboratory) -> None:
    spec = laboratory.spec(begins=0.5, position=0.505, stale=0.05)
    with laboratory.begun(spec, "--virtual", "--duration", "10") as (_, ended):
        told = ended()
    assert told.status == 0, told.out  # it never goes that far
    spec = laboratory.spec(begins=0.5, position=0.495, stale=0.05)
    with laboratory.begun(spec, "--virtual", "--duration", "10", "--out", str(laboratory.folder / "2")) as (
        _,
        ended,
    ):
        told = ended()
    assert_aborted(told, "position")
    assert "reads 0.5 m, allowed is 0.495 m" in told.json["abort"]["words"]


@pytest.mark.parametrize(
    ("limits", "limit", "words"),
    [
        ({"velocity": 0.5}, "velocity", "the velocity sensor of x1 reads"),
        pytest.param(
            {"measured_force": 3.05}, "measured_force", "the force sensor of a1 reads", marks=pytest.mark.long
        ),
        pytest.param({"following": 0.004}, "following", "the motor of a1 is", marks=pytest.mark.long),
        pytest.param(
            {"rate": 0.2, "hold": 0.1}, "hold", "the command has been at limits.rate", marks=pytest.mark.long
        ),
    ],
)
def test_what_the_rig_measures_ends_a_test(
    laboratory: Laboratory, limits: dict[str, float], limit: str, words: str
) -> None:
    told = in_simulated_time(laboratory, **limits)
    assert_aborted(told, limit)
    abort = told.json["abort"]
    assert words in abort["words"]
    assert abort["value"] > abort["allowed"] == limits[limit]
    u_d = told.recording.tables["actuator/command"].columns("position", ["a1"])[:, 0]
    assert u_d[-1] == u_d[0]


@pytest.mark.parametrize("on_abort", ["hold", pytest.param("unload", marks=pytest.mark.long)])
def test_motors_stay_or_let_go_where_that_is_asked_for(laboratory: Laboratory, on_abort: str) -> None:
    told = in_simulated_time(laboratory, velocity=1.0, on_abort=on_abort)
    assert_aborted(told, "velocity")
    recording, at = told.recording, told.json["abort"]["at"]
    commands, plant = recording.tables["actuator/command"], recording.plant
    u_d, x1 = (table.columns("position", [name])[:, 0] for table, name in ((commands, "a1"), (plant, "x1")))
    after = recording.seconds(commands.stamp_ns) > at
    assert abs(u_d[-1] - u_d[0]) > 0.01
    if on_abort == "hold":
        assert np.ptp(u_d[after]) == 0.0
        return
    rests = commands.stamp_ns[np.flatnonzero(np.diff(u_d))[-1] + 1]
    ahead = shipped_spec().timing.ns("tau4")  # in simulated time the plant may be so far ahead
    lately = np.abs(plant.stamp_ns - rests) <= ahead
    assert x1[lately].min() <= u_d[-1] <= x1[lately].max()  # where the wire pulled with nothing
    assert np.ptp(u_d[after]) > 0.0
