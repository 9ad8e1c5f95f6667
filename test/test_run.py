"""A run from its start to its end, and every way in which it can end too early."""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.recording import Recording, read_recording
from rthm_analysis.timing import RecordedSchedule
from rthm_core.engine import simulate

pytestmark = [pytest.mark.usefixtures("nothing_left")]
RUN = [sys.executable, "-m", "rthm_bringup", "run"]
NODES = ("rthm_plant_sim", "rthm_numerical", "rthm_actuator", "rthm_analysis", "recorder_node")


@pytest.fixture
def out(tmp_path: Path) -> Path:
    return tmp_path / "out"


@pytest.fixture
def long_run(environment: dict[str, str], out: Path) -> Iterator[subprocess.Popen[str]]:
    """A run without an end, some seconds after its begin."""
    command = [*RUN, "--duration", "0", "--out", str(out), "--json", str(out.parent / "result.json")]
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as run:
        deadline = time.monotonic() + 240
        while samples_in(out) < 40_000 and run.poll() is None and time.monotonic() < deadline:
            time.sleep(0.1)
        assert run.poll() is None, run.communicate()
        yield run
        run.kill()


def samples_in(out: Path) -> int:
    """Bytes of the recording so far."""
    return sum(file.stat().st_size for file in (out / "bag").glob("*.mcap"))


def cuts(bag: str | Path) -> list[str]:
    """What a reader says of a bag that is not whole."""
    return [note for note in read_recording(bag).notes if "cut off" in note or "damaged" in note]


def node(run: subprocess.Popen[str], module: str) -> int:
    """Process id of a node of the run."""
    for child in children(run.pid):
        if module.encode() in Path(f"/proc/{child}/cmdline").read_bytes():
            return child
    raise AssertionError(f"{module} does not run")


def children(pid: int) -> list[int]:
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def result(run: subprocess.Popen[str], out: Path) -> dict:
    run.wait(60)
    file = out.parent / "result.json"
    assert file.is_file(), run.communicate()
    return json.loads(file.read_text())


def off_along_recorded_delays(recording: Recording) -> float:
    """Largest difference of x1, m, between a recording and the exact engine along the delays that it had,
    however late the machine was.
    """
    spec = recording.spec
    assert spec is not None
    motion = simulate(spec, 2.0, energies=False, schedule=RecordedSchedule(spec, recording))
    x1 = recording.plant.columns("position", ["x1"])
    return float(np.abs(x1 - motion.plant_position[: x1.shape[0]]).max())


@pytest.mark.parametrize(
    "mode",
    [[], ["--compose"], pytest.param(["--virtual"], marks=pytest.mark.long)],  # `test_virtual` runs two
    ids=["real time", "composed", "virtual"],
)
def test_a_run_ends_by_itself_with_a_bag_and_a_report(
    environment: dict[str, str], out: Path, mode: list[str]
) -> None:
    command = [*RUN, "paper", "--duration", "2", "--out", str(out), "--json", "-", *mode]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    told = json.loads(done.stdout)
    recording = read_recording(told["bag"])
    assert cuts(told["bag"]) == []
    assert len(recording.plant) == 2_000_000_000 // 1_200_000 + 1
    assert len(recording.tables["numerical/state"]) == 2_000_000_000 // 12_000_000 + 1
    assert recording.tables["actuator/command"].stamp_ns[0] == recording.start_ns
    assert Path(told["report"]).stat().st_size > 10_000
    assert told["duration"] == 2.0
    assert {"mean", "p50", "p99", "max"} <= set(told["links"]["tau1"]["excess"])
    assert told["energies"]["E_fx"] != 0.0
    lost = recording.diagnostics["/rthm/recorder"].get("lost")
    assert off_along_recorded_delays(recording) < 1e-11, f"lost by the recorder: {lost}; {recording.notes}"
    logs = {log.stem for log in (out / "log").glob("*.log")}
    assert ("numerical+actuator" in logs, "actuator" in logs) == (
        "--compose" in mode,
        "--compose" not in mode,
    )
    assert set(told["energies"]) >= {"E_num", "E_ff", "E_fx", "E_err", "E_damping", "E_total"}


def test_ctrl_c_ends_a_run_in_good_order(long_run: subprocess.Popen[str], out: Path) -> None:
    long_run.send_signal(signal.SIGINT)
    told = result(long_run, out)
    assert long_run.returncode == 0, told
    assert told["interrupted"]
    assert told["problems"] == []
    assert (out / "bag" / "metadata.yaml").is_file()
    assert cuts(out / "bag") == []


def test_the_death_of_the_plant_ends_a_run_with_status_1(long_run: subprocess.Popen[str], out: Path) -> None:
    os.kill(node(long_run, "rthm_plant_sim"), signal.SIGKILL)
    told = result(long_run, out)
    assert long_run.returncode == 1
    assert told["problems"][0].startswith("plant was killed by SIGKILL")
    assert (out / "bag" / "metadata.yaml").is_file()
    assert len(read_recording(out / "bag").plant) > 100


def test_the_death_of_the_recorder_leaves_a_readable_bag(
    host_stalls: Callable[[float], float], long_run: subprocess.Popen[str], out: Path
) -> None:
    os.kill(node(long_run, "recorder_node"), signal.SIGKILL)
    killed, allowed = time.time_ns(), int(1e9 * (1.0 + host_stalls(5.0)))
    told = result(long_run, out)
    assert long_run.returncode == 1
    assert told["problems"][0].startswith("recorder was killed by SIGKILL")
    assert read_recording(out / "bag").plant.stamp_ns[-1] > killed - allowed


def test_a_disk_that_is_full_ends_a_run_with_one_sentence(long_run: subprocess.Popen[str], out: Path) -> None:
    full = samples_in(out) + 100_000
    resource.prlimit(node(long_run, "recorder_node"), resource.RLIMIT_FSIZE, (full, full))
    told = result(long_run, out)
    assert long_run.returncode == 1
    assert "The recording cannot be written" in told["problems"][0]
    assert len(read_recording(out / "bag").plant) > 100


def test_a_killed_launcher_leaves_no_node_behind(
    long_run: subprocess.Popen[str], out: Path, own_processes: Callable[[], list[str]]
) -> None:
    long_run.kill()
    long_run.wait()
    deadline = time.monotonic() + 30
    while own_processes() and time.monotonic() < deadline:
        time.sleep(0.1)
    assert (out / "bag" / "metadata.yaml").is_file()
    assert cuts(out / "bag") == []


def test_a_folder_with_a_recording_is_not_overwritten(environment: dict[str, str], out: Path) -> None:
    (out / "bag").mkdir(parents=True)
    (out / "bag" / "precious").write_text("")
    done = subprocess.run(
        [*RUN, "--out", str(out)], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "none is overwritten" in done.stderr
