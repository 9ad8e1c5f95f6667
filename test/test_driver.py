"""A driver of somebody else takes the place of the simulated plant."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.recording import read_recording
from rthm_bringup.run.environment import Network
from rthm_core.spec import LimitsSpec, shipped_spec, write_spec

pytestmark = [pytest.mark.usefixtures("nothing_left")]
DRIVER = Path(__file__).parent / "programs" / "driver.py"
RUN = [sys.executable, "-m", "rthm_bringup", "run"]


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    """The paper's test with limits; the driver pulls with no force where the spec begins with 3 N."""
    limits = LimitsSpec(
        command=1.0, rate=20.0, force=50.0, stale=0.5, ramp=0.2, start=(0.1, 4.0), heartbeat=1.0
    )
    file = tmp_path / "rig.yaml"
    file.write_text(write_spec(shipped_spec().model_copy(update={"limits": limits})))
    return file


def test_the_driver_imports_nothing_of_the_project() -> None:
    assert "rthm_" not in DRIVER.read_text()


def test_a_small_publisher_replaces_the_plant(
    environment: dict[str, str], network: Network, tmp_path: Path, rig: Path
) -> None:
    options = [
        str(rig),
        "--plant",
        "external",
        "--duration",
        "2",
        "--out",
        str(tmp_path / "out"),
        "--json",
        "-",
    ]
    with subprocess.Popen([sys.executable, str(DRIVER), "600"], env=environment) as driver:
        done = subprocess.run([*RUN, *options], env=environment, capture_output=True, text=True, check=False)
        driver.terminate()
    assert done.returncode == 0, done.stdout + done.stderr
    recording = read_recording(json.loads(done.stdout)["bag"])
    plant, commands = recording.plant, recording.tables["actuator/command"]
    assert plant.names == ("x1", "a1")
    assert plant.stamp_ns[0] - commands.stamp_ns[0] in (0, 1_200_000)
    assert 1 + 2_000_000_000 // 1_200_000 - len(plant) <= 1
    assert set(np.diff(plant.stamp_ns).tolist()) == {1_200_000}
    used = recording.links["tau1"]
    assert np.isin(used.sample_ns, plant.stamp_ns).all()
    assert len(used) > 100  # of 500; a host that is busy delivers the first ones late
    assert "tau4" not in recording.links


def test_names_that_the_spec_does_not_know_are_refused(
    environment: dict[str, str], network: Network, tmp_path: Path, rig: Path
) -> None:
    rig.write_text(rig.read_text().replace('"x1"', '"head"'))
    options = [str(rig), "--plant", "external", "--duration", "2", "--out", str(tmp_path / "out")]
    with subprocess.Popen([sys.executable, str(DRIVER), "600"], env=environment) as driver:
        done = subprocess.run([*RUN, *options], env=environment, capture_output=True, text=True, check=False)
        driver.terminate()
    assert done.returncode == 1
    assert "['x1', 'a1']" in done.stdout
    assert "['head', 'a1']" in done.stdout
