"""A driver on the project's base takes the place of the simulated plant; pulling the device ends the test."""

from __future__ import annotations

import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import numpy as np
import pytest
from benchmarks.rigs import RTHM, Runs, Told

from rthm_analysis.recording import Recording
from rthm_bringup.run.environment import Network
from rthm_core.clock import NS
from rthm_core.spec import LimitsSpec, Spec, apply, shipped_spec, spec_at, write_spec

pytestmark = [pytest.mark.graph, pytest.mark.usefixtures("nothing_left")]
EXAMPLES = Path(__file__).parents[1] / "examples"
STAND_IN = Path(__file__).parent / "programs" / "ros2_control.py"
STANDS, RATE = 0.1, 5.0
LIMITS = LimitsSpec(command=1.0, rate=RATE, force=50.0, stale=0.5, ramp=0.5, heartbeat=1.0, start=(0.02, 1.0))
"""A sample that a busy machine holds up is not called stale."""


class Laboratory(Runs):
    """Devices, drivers and runs in one domain."""

    def __init__(self, environment: dict[str, str], folder: Path) -> None:
        super().__init__(environment, folder)
        self.spec = self.written(
            apply(shipped_spec(), {"plant.initial_position": [STANDS]}).model_copy(update={"limits": LIMITS})
        )

    def written(self, spec: Spec) -> Path:
        """File with a spec."""
        file = self.folder / "rig.yaml"
        file.write_text(write_spec(spec))
        return file

    def at_rest(self) -> Path:
        """The spec of the examples, which begins at rest; a busy machine may be late."""
        rig = spec_at(EXAMPLES / "rig.yaml")
        return self.written(apply(rig, {"limits.stale": 0.5, "limits.heartbeat": 1.0}))

    @contextmanager
    def process(self, *command: str | Path) -> Iterator[subprocess.Popen[bytes]]:
        with subprocess.Popen([str(word) for word in command], env=self.environment) as one:
            try:
                yield one
            finally:
                one.send_signal(signal.SIGCONT)
                one.terminate()

    def begun_beside(
        self, *options: str
    ) -> AbstractContextManager[tuple[subprocess.Popen[str], Callable[[], Told]]]:
        """A run whose plant is not its own, as a process, and what ends it."""
        return self.begun(self.spec, "--plant", "external", *options)


def free_port() -> int:
    """UDP port that nobody has."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


@pytest.fixture
def laboratory(environment: dict[str, str], network: Network, tmp_path: Path) -> Laboratory:
    return Laboratory(environment, tmp_path)


def assert_within_rate(recording: Recording, stands: float = STANDS) -> None:
    """The motor, as its driver measures it, moved within the rate and began where it stood."""
    u = np.concatenate([[stands], recording.plant.columns("position", ["a1"])[:, 0]])
    waits = np.concatenate([[0.004], np.diff(recording.plant.stamp_ns) / NS]) + 0.004
    assert np.all(np.abs(np.diff(u)) <= RATE * waits + 1e-9)


def test_a_driver_of_fifteen_lines_takes_the_place_of_the_plant(laboratory: Laboratory) -> None:
    code = [line for line in (EXAMPLES / "driver.py").read_text().splitlines()[1:] if line.strip()]
    assert len(code) <= 15
    with (
        laboratory.process(sys.executable, EXAMPLES / "driver.py", laboratory.spec),
        laboratory.begun_beside("--duration", "3") as (_, end),
    ):
        ended = end()
    assert ended.status == 0, ended.out
    assert ended.json["abort"] is None
    recording = ended.recording
    assert_within_rate(recording)
    assert set(np.diff(recording.plant.stamp_ns).tolist()) == {1_200_000}
    assert np.ptp(recording.plant.columns("position", ["a1"])) > 0.02
    assert len(recording.links["tau4"]) > 100


@pytest.mark.long
def test_a_driver_that_stalled_makes_the_samples_of_the_ticks_that_went_by(
    laboratory: Laboratory,
) -> None:
    with (
        laboratory.process(sys.executable, EXAMPLES / "driver.py", laboratory.spec) as driver,
        laboratory.begun_beside("--duration", "4") as (run, end),
    ):
        laboratory.wait_until_it_moves(run)
        os.kill(driver.pid, signal.SIGSTOP)
        time.sleep(0.2)
        os.kill(driver.pid, signal.SIGCONT)
        ended = end()
    assert ended.status == 0, ended.out
    assert set(np.diff(ended.recording.plant.stamp_ns).tolist()) == {1_200_000}
    late = ended.recording.plant.sent_ns - ended.recording.plant.stamp_ns
    assert late.max() > 0.1 * NS


@pytest.mark.long
@pytest.mark.parametrize("number", [signal.SIGSTOP, signal.SIGTERM])
def test_a_driver_that_is_gone_ends_the_test(laboratory: Laboratory, number: signal.Signals) -> None:
    with (
        laboratory.process(sys.executable, EXAMPLES / "driver.py", laboratory.spec) as driver,
        laboratory.begun_beside("--duration", "30") as (run, end),
    ):
        laboratory.wait_until_it_moves(run)
        os.kill(driver.pid, number)
        ended = end()
    assert ended.status == 3, ended.out
    assert ended.json["abort"]["limit"] == "stale"
    assert ended.json["abort"]["at"] < 20.0
    assert_within_rate(ended.recording)


@contextmanager
def emulated(laboratory: Laboratory) -> Iterator[tuple[subprocess.Popen[bytes], str]]:
    """The emulated device in Python, at rest, and its address."""
    spec, port = laboratory.at_rest(), free_port()
    command = [sys.executable, "-m", "rthm_plant_sim.udp.emulated", spec, str(port)]
    with laboratory.process(*command) as device:
        yield device, f"127.0.0.1:{port}"


@contextmanager
def in_c(laboratory: Laboratory) -> Iterator[tuple[subprocess.Popen[bytes], str]]:
    """The C example at 0.1 m, and its address."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        pytest.skip("no C compiler (cc, gcc, clang) is on the path")
    program, port = laboratory.folder / "udp_device", free_port()
    sources = [EXAMPLES / "udp_device.c", EXAMPLES / "udp_device_posix.c"]
    subprocess.run([compiler, "-std=c99", "-O2", "-o", program, *sources, "-lm"], check=True)
    with laboratory.process(program, str(port), str(STANDS)) as device:
        yield device, f"127.0.0.1:{port}"


Kind = Callable[[Laboratory], AbstractContextManager[tuple[subprocess.Popen[bytes], str]]]


@pytest.mark.parametrize("kind", [emulated, pytest.param(in_c, marks=pytest.mark.long)])
def test_a_device_behind_udp_takes_the_place_of_the_plant(laboratory: Laboratory, kind: Kind) -> None:
    with (
        kind(laboratory) as (_, address),
        laboratory.process(sys.executable, "-m", "rthm_plant_sim.udp", laboratory.spec, address),
        laboratory.begun_beside("--duration", "3") as (_, end),
    ):
        ended = end()
    assert ended.status == 0, ended.out
    assert ended.json["abort"] is None
    recording = ended.recording
    assert_within_rate(recording, 0.0 if kind is emulated else STANDS)
    assert np.ptp(recording.plant.columns("position", ["a1"])) > 0.01
    assert set(np.diff(recording.plant.stamp_ns).tolist()) == {1_200_000}


@pytest.mark.parametrize("number", [pytest.param(signal.SIGSTOP, marks=pytest.mark.long), signal.SIGKILL])
def test_a_device_that_is_pulled_ends_the_test(laboratory: Laboratory, number: signal.Signals) -> None:
    with (
        emulated(laboratory) as (device, address),
        laboratory.process(sys.executable, "-m", "rthm_plant_sim.udp", laboratory.spec, address),
        laboratory.begun_beside("--duration", "30") as (run, end),
    ):
        laboratory.wait_until_it_moves(run)
        os.kill(device.pid, number)
        ended = end()
    assert ended.status == 3, ended.out
    assert ended.json["abort"]["limit"] == "stale"
    assert ended.json["abort"]["at"] < 20.0


def test_a_whole_test_under_ros2_control_ends_with_status_0(laboratory: Laboratory) -> None:
    bridge = [sys.executable, "-m", "rthm_plant_sim.ros2_control", laboratory.spec]
    with (
        laboratory.process(sys.executable, STAND_IN, str(STANDS)),
        laboratory.process(*bridge, "--joints", "x1=table,a1=piston"),
        laboratory.begun_beside("--duration", "3") as (_, end),
    ):
        ended = end()
    assert ended.status == 0, ended.out
    assert ended.json["abort"] is None and not ended.json["problems"]
    recording = ended.recording
    assert_within_rate(recording)
    assert set(np.diff(recording.plant.stamp_ns).tolist()) == {1_200_000}
    assert np.ptp(recording.plant.columns("position", ["a1"])) > 0.02


@pytest.mark.long
def test_a_rig_under_ros2_control_takes_the_place_of_the_plant(laboratory: Laboratory) -> None:
    bridge = [sys.executable, "-m", "rthm_plant_sim.ros2_control", laboratory.spec]
    with (
        laboratory.process(sys.executable, STAND_IN, str(STANDS)) as manager,
        laboratory.process(*bridge, "--joints", "x1=table,a1=piston"),
        laboratory.begun_beside("--duration", "60") as (run, end),
    ):
        laboratory.wait_until_it_moves(run)
        manager.terminate()
        ended = end()
    assert ended.status == 3, ended.out
    assert ended.json["abort"]["limit"] == "stale"
    recording = ended.recording
    assert recording.plant.names == ("x1", "a1")
    assert_within_rate(recording)
    assert np.ptp(recording.plant.columns("position", ["a1"])) > 0.0
    assert len(recording.links["tau4"]) > 10


@pytest.mark.long
def test_a_class_is_a_driver_that_a_forged_command_does_not_move(laboratory: Laboratory) -> None:
    """Commands from nowhere are refused; a swing that begins where the motor stands is followed."""
    rig, moved = laboratory.folder / "rig.py", laboratory.folder / "moved"
    code = (EXAMPLES / "driver.py").read_text().replace("sys.exit(drive(Rig(), sys.argv[1]))", "")
    rig.write_text(code + f'        open("{moved}", "a").write(f"{{self.u}}\\n")\n')
    rival = [sys.executable, STAND_IN.with_name("rival.py"), "actuator/command", "8"]
    check = ["check-driver", laboratory.spec, "--swing", "0.05", "--seconds", "3", "--wait", "60"]
    check += ["--json", laboratory.folder / "checks.json"]
    with laboratory.process(*RTHM, "driver", laboratory.spec, "--python", f"{rig}:Rig"):
        heard = subprocess.run(rival, env=laboratory.environment, capture_output=True, text=True, check=True)
        assert not moved.exists()
        subprocess.run([*RTHM, *check], env=laboratory.environment, check=False)
    assert int(heard.stdout.split()[-1]) > 100  # while it published
    checks = {
        one["name"]: one for one in json.loads((laboratory.folder / "checks.json").read_text())["checks"]
    }
    assert checks["answers"]["passed"], checks["answers"]["words"]
    assert checks["names"]["passed"] and checks["one publisher"]["passed"]
    u = [float(line) for line in moved.read_text().splitlines()]
    assert u[0] == pytest.approx(STANDS, abs=0.02)
    assert STANDS + 0.04 < max(u) <= STANDS + 0.05 + 1e-9
