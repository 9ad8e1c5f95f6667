"""A device whose sensors are off: refused, zeroed, and right; and one with a load cell that is reversed."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from benchmarks.rigs import RTHM, Runs
from test_driver_base import free_port

from rthm_analysis.recording import read_recording
from rthm_core.spec import apply, spec_at, write_spec

pytestmark = [pytest.mark.graph, pytest.mark.long, pytest.mark.usefixtures("nothing_left")]
EXAMPLES = Path(__file__).parents[1] / "examples"
OFF: dict[str, Any] = {
    "effects": ["cell", "encoder"],
    "cell": {"block": "sensor.force", "kind": "bias", "actuator": "a1", "bias": 0.8},
    "encoder": {"block": "sensor.position", "kind": "bias", "dof": "x1", "bias": 0.02},
    "noise": {"position": 1e-4, "motor": 1e-5, "force": 0.02},
}


class Laboratory(Runs):
    """A device of our own, its driver, and verbs."""

    @contextmanager
    def process(self, *command: str | Path) -> Iterator[None]:
        with subprocess.Popen([str(word) for word in command], env=self.environment) as one:
            try:
                yield
            finally:
                one.terminate()

    @contextmanager
    def device(self, faults: dict[str, object]) -> Iterator[Path]:
        """The emulated device with faults, driven; the spec, which knows nothing of them."""
        right = apply(spec_at(EXAMPLES / "rig.yaml"), {"limits.stale": 0.5, "limits.heartbeat": 1.0})
        rig, wrong, port = self.folder / "rig.yaml", self.folder / "device.yaml", free_port()
        rig.write_text(write_spec(right))
        wrong.write_text(write_spec(apply(right, faults)))
        emulated = [sys.executable, "-m", "rthm_plant_sim.udp.emulated", wrong, str(port)]
        with self.process(*emulated), self.process(*RTHM, "driver", rig, "--udp", f"127.0.0.1:{port}"):
            yield rig

    def verb(self, *words: str | Path) -> subprocess.CompletedProcess[str]:
        command = [*RTHM, *map(str, words), "--json", "told.json"]
        return subprocess.run(
            command, cwd=self.folder, env=self.environment, capture_output=True, text=True, check=False
        )

    def told(self) -> dict[str, object]:
        return dict(json.loads((self.folder / "told.json").read_text()))


@pytest.fixture
def laboratory(environment: dict[str, str], tmp_path: Path) -> Laboratory:
    return Laboratory(environment, tmp_path)


def test_a_zeroed_rig_reads_what_its_spec_says_and_the_run_tells_what_was_subtracted(
    laboratory: Laboratory,
) -> None:
    with laboratory.device(OFF) as rig:
        zeroed = laboratory.verb("zero", rig, "-o", "zeroed.yaml", "--seconds", "2")
        assert zeroed.returncode == 0, zeroed.stdout + zeroed.stderr
        run = laboratory.verb(
            "run", "zeroed.yaml", "--plant", "external", "--duration", "1.5", "--out", "out"
        )
    assert run.returncode == 0, run.stdout + run.stderr
    told = laboratory.told()
    assert isinstance(told["zero"], dict)
    assert told["zero"]["force"] == pytest.approx([0.8], abs=0.01)
    assert told["zero"]["position"] == pytest.approx([0.02], abs=1e-4)
    recording = read_recording(laboratory.folder / "out" / "bag")
    assert recording.known_spec().zero == spec_at(laboratory.folder / "zeroed.yaml").zero
    first = recording.plant.rows(np.arange(20))
    assert np.mean(first.columns("effort", ["a1"])) == pytest.approx(0.0, abs=0.03)
    assert np.mean(first.columns("position", ["x1"])) == pytest.approx(0.0, abs=3e-4)


def test_a_driver_that_takes_no_offsets_is_refused_them(laboratory: Laboratory) -> None:
    spec = spec_at(EXAMPLES / "rig.yaml")
    (laboratory.folder / "rig.yaml").write_text(write_spec(apply(spec, {"zero.force": [0.8]})))
    driver = Path(__file__).parent / "programs" / "driver.py"
    with laboratory.process(sys.executable, driver, "600", "0.0"):
        run = laboratory.verb("run", "rig.yaml", "--plant", "external", "--duration", "1", "--out", "out")
    assert run.returncode == 1
    assert "the driver does not subtract it" in run.stdout


def test_a_rig_is_armed_once_the_pretension_of_its_wires_was_measured(laboratory: Laboratory) -> None:
    """The wire of the device pulls 5 N more than by its motion."""
    pulls = {"effects": ["cell"], "cell": {**OFF["cell"], "bias": 5.0}}
    with laboratory.device(pulls) as rig:
        slack = apply(spec_at(rig), {"actuator.pretension": [5.0], "zero.force": [0.0]})
        (laboratory.folder / "slack.yaml").write_text(write_spec(slack))
        options = ("--plant", "external", "--duration", "1.5")
        refused = laboratory.verb("run", "slack.yaml", *options, "--out", "refused")
        led = laboratory.verb("pretension", "slack.yaml", "-o", "tensioned.yaml", "--patience", "60")
        run = laboratory.verb("run", "tensioned.yaml", *options, "--out", "out")
    assert refused.returncode == 1
    assert "the pretension of a1 is 5 N by the spec and was not measured" in refused.stdout
    assert led.returncode == 0, led.stdout + led.stderr
    assert "N of 5 +- 0.25 N, right" in led.stderr
    assert run.returncode == 0, run.stdout + run.stderr
    tensioned = spec_at(laboratory.folder / "tensioned.yaml").zero
    assert tensioned is not None
    assert tensioned.tension == pytest.approx([5.0], abs=0.01)
    first = read_recording(laboratory.folder / "out" / "bag").plant.rows(np.arange(20))
    assert np.mean(first.columns("effort", ["a1"])) == pytest.approx(0.0, abs=0.03)


def test_a_reversed_load_cell_is_one_sentence_and_no_spec(laboratory: Laboratory) -> None:
    rig = laboratory.folder / "rig.yaml"
    right = apply(spec_at(EXAMPLES / "rig.yaml"), {"limits.stale": 0.5, "limits.heartbeat": 1.0})
    rig.write_text(write_spec(right))
    code = (EXAMPLES / "driver.py").read_text().replace("sys.exit(drive(Rig(), sys.argv[1]))", "")
    file = laboratory.folder / "device.py"
    file.write_text(code.replace("x = u = 0.1", "x = u = 0.0").replace("40.0 *", "-40.0 *"))
    with laboratory.process(*RTHM, "driver", rig, "--python", f"{file}:Rig"):
        found = laboratory.verb("check-driver", rig, "--measure", "measured.yaml", "--wait", "60")
    assert found.returncode == 1, found.stdout
    assert "the force has the wrong sign, + has to pull a1's dof along + x" in found.stdout
    assert "No spec was written." in found.stdout
    assert not (laboratory.folder / "measured.yaml").exists()
