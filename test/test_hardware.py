"""A driver of somebody else stands at 0.1 m: nothing jumps, and whatever fails ends the test as an abort."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rigs import RTHM, Runs, Told

from rthm_analysis.recording import Recording, read_recording
from rthm_analysis.recording.files import read_raw
from rthm_bringup.run.environment import Network
from rthm_core.clock import NS
from rthm_core.spec import LimitsSpec, shipped_spec, write_spec

pytestmark = [pytest.mark.graph, pytest.mark.usefixtures("nothing_left")]
DRIVER = Path(__file__).parent / "programs" / "driver.py"
OPERATOR = DRIVER.with_name("operator.py")
STANDS = 0.1
RATE, RAMP = 5.0, 0.5
LIMITS = {"command": 1.0, "rate": RATE, "force": 50.0, "stale": 0.5, "ramp": RAMP, "heartbeat": 1.0}
"""A sample that a busy machine holds up is not called stale."""


class Laboratory(Runs):
    """A driver at 0.1 m, and a run with it."""

    def spec(self, begins: float = STANDS, **limits: Any) -> Path:
        """A spec whose plant begins somewhere; its motor stands 15 mm away from this driver's."""
        paper = shipped_spec()
        plant = paper.plant.model_copy(update={"initial_position": (begins,)})
        given = LIMITS | {"start": (0.02, 1.0)} | limits
        kept = LimitsSpec(**{name: value for name, value in given.items() if value is not None})
        file = self.folder / "rig.yaml"
        file.write_text(write_spec(paper.model_copy(update={"plant": plant, "limits": kept})))
        return file

    @contextmanager
    def driver(self, *fault: str) -> Iterator[None]:
        command = [sys.executable, str(DRIVER), "600", str(STANDS), *fault]
        with subprocess.Popen(command, env=self.environment) as driver:
            try:
                yield
            finally:
                driver.terminate()

    def run(self, spec: Path, *options: str, fault: tuple[str, ...] = ()) -> Told:
        """A run with the driver, from its begin to its end."""
        with self.driver(*fault), self.begun(spec, "--plant", "external", *options) as (_, ended):
            return ended()


@pytest.fixture
def laboratory(environment: dict[str, str], network: Network, tmp_path: Path) -> Laboratory:
    return Laboratory(environment, tmp_path)


def process(run: subprocess.Popen[str], module: str) -> int:
    """Process id of a node of the run."""
    for child in Path(f"/proc/{run.pid}/task/{run.pid}/children").read_text().split():
        if module.encode() in Path(f"/proc/{child}/cmdline").read_bytes():
            return int(child)
    raise AssertionError(f"{module} does not run")


def assert_no_jump(recording: Recording, stands: float = STANDS) -> None:
    """Every step of the command is within the rate, the first one is from where the motor stands."""
    commands = recording.tables["actuator/command"]
    u_d = np.concatenate([[stands], commands.columns("position", ["a1"])[:, 0]])
    waits = np.concatenate([[0.004], np.diff(commands.stamp_ns) / NS])
    assert np.all(np.abs(np.diff(u_d)) <= RATE * waits + 1e-12)
    assert np.all(np.abs(np.diff(u_d)) <= RATE * 0.004 + 1e-12)


def assert_aborted(told: Told, limit: str, status: int = 3) -> None:
    """The abort is in the status, the JSON, the first line, the page and the bag."""
    assert told.status == status, told.out
    abort = told.json["abort"]
    assert abort["limit"] == limit, told.out
    first = next(line for line in told.out.splitlines() if line.startswith("Aborted"))
    assert first == f"Aborted at {abort['at']:.3f} s: {abort['words']}"
    assert told.page.index("Aborted at") < told.page.index("<h1>")


def assert_back_at_rest(told: Told, stands: float = STANDS) -> None:
    """The motors are back where they stood, a ramp after the abort."""
    recording, abort = told.recording, told.json["abort"]
    assert recording.abort is not None
    assert recording.abort.words == abort["words"]
    commands = recording.tables["actuator/command"]
    u_d = commands.columns("position", ["a1"])[:, 0]
    assert u_d[-1] == stands
    moved = commands.stamp_ns[np.flatnonzero(np.diff(u_d))[-1] + 1] - recording.start_ns
    period = 0.1 + told.json["clocks"]["td3"]["missed"] * 0.004
    assert moved / NS <= abort["at"] + RAMP + period


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


@pytest.mark.parametrize(
    ("fault", "limit", "words"),
    [
        ("nan", "finite", "the force sensor of a1 reads not a number"),
        pytest.param("step", "step", "the position sensor of x1 steps by", marks=pytest.mark.long),
        pytest.param("frozen", "frozen", "the position sensor of x1 has read", marks=pytest.mark.long),
        pytest.param("old", "stale", "plant/state has had no fresh sample", marks=pytest.mark.long),
        pytest.param("silent", "stale", "plant/state has had no fresh sample", marks=pytest.mark.long),
    ],
)
def test_a_fault_of_the_rig_ends_the_test_as_an_abort(
    laboratory: Laboratory, fault: str, limit: str, words: str
) -> None:
    told = laboratory.run(laboratory.spec(), "--duration", "30", fault=(fault, "1.5"))
    assert_aborted(told, limit)
    assert words in told.json["abort"]["words"]
    assert told.json["abort"]["at"] < 10.0
    assert_no_jump(told.recording)
    assert_back_at_rest(told)


@pytest.mark.parametrize("way", ["service", pytest.param("topic", marks=pytest.mark.long), "heartbeat"])
def test_a_test_is_aborted_from_outside(laboratory: Laboratory, way: str) -> None:
    options = ["--plant", "external", "--duration", "30"] + ["--heartbeat"] * (way == "heartbeat")
    operator = subprocess.Popen([sys.executable, str(OPERATOR), way], env=laboratory.environment)
    with operator, laboratory.driver(), laboratory.begun(laboratory.spec(), *options) as (run, ended):
        laboratory.wait_until_it_moves(run)
        operator.terminate()  # it aborts, or its heartbeat ends
        told = ended()
    assert_aborted(told, "heartbeat" if way == "heartbeat" else "operator")
    assert_no_jump(told.recording)
    assert_back_at_rest(told)


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
    assert_aborted(told, "operator")
    assert told.json["abort"]["words"] == "the key a was pressed"
    assert_no_jump(told.recording)
    assert_back_at_rest(told)


@pytest.mark.parametrize(
    ("module", "number", "status", "limit"),
    [
        ("rthm_actuator", signal.SIGSTOP, 3, "heartbeat"),
        pytest.param("rthm_numerical", signal.SIGSTOP, 3, "stale", marks=pytest.mark.long),
        pytest.param("recorder_node", signal.SIGSTOP, 3, "heartbeat", marks=pytest.mark.long),
        ("recorder_node", signal.SIGKILL, 1, "node"),
        pytest.param("rthm_actuator", signal.SIGKILL, 1, "node", marks=pytest.mark.long),
    ],
)
def test_a_node_that_is_gone_ends_the_test(
    laboratory: Laboratory, module: str, number: signal.Signals, status: int, limit: str
) -> None:
    options = ("--plant", "external", "--duration", "60")
    with laboratory.driver(), laboratory.begun(laboratory.spec(), *options) as (run, ended):
        laboratory.wait_until_it_moves(run)
        os.kill(process(run, module), number)
        told = ended()
    assert told.json["abort"]["at"] < 30.0
    assert_aborted(told, limit, status)
    assert_no_jump(told.recording)
    if module not in ("rthm_actuator", "recorder_node"):
        assert_back_at_rest(told)


def test_the_death_of_an_observer_does_not_end_the_test(laboratory: Laboratory) -> None:
    options = ("--plant", "external", "--duration", "4")
    with laboratory.driver(), laboratory.begun(laboratory.spec(), *options) as (run, ended):
        laboratory.wait_until_it_moves(run)
        os.kill(process(run, "rthm_analysis"), signal.SIGKILL)
        told = ended()
    assert told.status == 1
    assert told.json["abort"] is None
    assert [one.split(" (")[0] for one in told.json["problems"]] == ["analysis was killed by SIGKILL"]
    assert told.recording.duration == pytest.approx(4.0, abs=0.01)


def test_a_controller_that_was_held_up_does_not_catch_up(laboratory: Laboratory) -> None:
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


@pytest.mark.long
def test_a_simulated_plant_that_is_stopped_ends_the_test(laboratory: Laboratory) -> None:
    with laboratory.begun(laboratory.spec(), "--duration", "60") as (run, ended):
        laboratory.wait_until_it_moves(run)
        os.kill(process(run, "rthm_plant_sim"), signal.SIGSTOP)
        told = ended()
    assert_aborted(told, "stale")
    begins = told.recording.tables["actuator/command"].columns("position", ["a1"])[0, 0]
    assert_no_jump(told.recording, begins)
    assert_back_at_rest(told, begins)


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
