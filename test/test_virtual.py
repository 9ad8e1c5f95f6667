"""A run in simulated time: separate processes, and yet the exact engine's motion, the same every time."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from benchmarks.realtime.compare import payloads, worst_difference

from rthm_analysis.recording import read_recording
from rthm_core.schedule import Schedule
from rthm_core.spec import parameters, read_spec, shipped_spec, spec_from_parameters, write_spec

pytestmark = pytest.mark.usefixtures("nothing_left")
RUN = [sys.executable, "-m", "rthm_bringup", "run"]
DURATION = 1.5
PAPER = {entry.name: entry.value for entry in parameters(shipped_spec())}
LATE_AND_LOST = {
    "effects": ["late", "lost"],
    "late.block": "link.tau1", "late.kind": "jitter", "late.std": 0.003,
    "lost.block": "link.tau3", "lost.kind": "loss", "lost.fraction": 0.2,
}  # fmt: skip
FRICTION = {
    "effects": ["late", "lost", "guide"],
    "guide.block": "plant", "guide.kind": "coulomb_friction", "guide.dof": "x1", "guide.force": 0.05,
}  # fmt: skip
FASTER = {
    "effects": ["motor_early", "state_early"],
    "motor_early.block": "motor", "motor_early.kind": "extra_delay", "motor_early.actuator": "a1",
    "motor_early.delay": -0.003,
    "state_early.block": "link.tau1", "state_early.kind": "extra_delay", "state_early.delay": -0.0015,
}  # fmt: skip
PREDICTION = {"actuator.compensator": "polynomial", "actuator.compensator_order": 3, "timing.tau3": 0.0105}
CHANGES = {
    "no delay at all": {f"timing.tau{k}": 0.0 for k in (1, 2, 3, 4)},
    "extra commands at once": {"timing.tau4": 0.0, "timing.tau3": 0.0105, "timing.td2": 0.007},
    "prediction at irregular stamps": LATE_AND_LOST | PREDICTION,
    "faster than the spec": FASTER,
}


def spec(changes: dict[str, Any], folder: Path) -> Path:
    file = folder / "spec.yaml"
    file.write_text(write_spec(spec_from_parameters(PAPER | changes)))
    return file


def run(environment: dict[str, str], file: Path, out: Path) -> Path:
    options = ["--virtual", "--duration", str(DURATION), "--out", str(out), "--json", "-"]
    done = subprocess.run(
        [*RUN, str(file), *options], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return Path(json.loads(done.stdout)["bag"])


def is_the_exact_engine(bag: Path, file: Path) -> None:
    recording = read_recording(bag)
    assert worst_difference(recording, read_spec(file), DURATION) < 1e-9
    schedule = Schedule(read_spec(file))
    end = round(DURATION * 1e9)
    assert len(recording.plant) == end // schedule.td1 + 1
    sent = recording.tables["actuator/command"].stamp_ns - recording.start_ns
    assert sent.tolist() == schedule.commands(0, end + 1).time.tolist()


@pytest.mark.long
@pytest.mark.parametrize("name", CHANGES)
def test_a_virtual_run_is_the_exact_engine(environment: dict[str, str], tmp_path: Path, name: str) -> None:
    file = spec(CHANGES[name], tmp_path)
    is_the_exact_engine(run(environment, file, tmp_path / "out"), file)


def test_repeated_it_gives_the_same_bytes_from_separate_processes_and_the_motion_of_the_exact_engine(
    environment: dict[str, str], tmp_path: Path, own_processes: Callable[[], list[str]]
) -> None:
    file = spec(LATE_AND_LOST | FRICTION, tmp_path)
    first = run(environment, file, tmp_path / "one")
    with ThreadPoolExecutor(1) as aside:
        waiting = aside.submit(run, environment, file, tmp_path / "two")
        seen: set[str] = set()
        while not waiting.done():
            seen |= set(own_processes())
            time.sleep(0.2)
        again = waiting.result()
    for package in ("rthm_plant_sim", "rthm_numerical", "rthm_actuator"):
        assert sum(f"-m {package}.node" in command for command in seen) == 1
    one, two = payloads(first), payloads(again)
    assert len(one["/rthm/plant/state"]) == 1251
    assert set(one) == set(two)
    assert all(one[topic] == two[topic] for topic in one)
    is_the_exact_engine(again, file)
