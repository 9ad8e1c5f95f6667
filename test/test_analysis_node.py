"""The analysis node: energy balance of a running test, and the analysis of a recording."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.energy import energy_of
from rthm_analysis.recording import read_recording
from rthm_bringup.run.conductor_node import Conductor
from rthm_bringup.run.environment import Network, has_wheels, without_parents_ros
from rthm_core.energy import TERMS

pytestmark = [pytest.mark.usefixtures("nothing_left")]

RTHM = [sys.executable, "-m", "rthm_bringup"]


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a run in simulated time."""
    folder = tmp_path_factory.mktemp("run") / "out"
    command = [*RTHM, "run", "--virtual", "--duration", "4", "--out", str(folder)]
    environment = without_parents_ros(os.environ, has_wheels())
    subprocess.run(command, env=environment, check=True, timeout=600, capture_output=True)
    return folder


@contextmanager
def analysis(environment: dict[str, str], *words: str) -> Iterator[subprocess.Popen[bytes]]:
    """Run the node by itself."""
    command = [sys.executable, "-m", "rthm_analysis.node", "--ros-args", *words]
    with subprocess.Popen(command, env=environment) as node:
        try:
            yield node
        finally:
            node.terminate()
            node.wait(timeout=30)


def energies(folder: Path, environment: dict[str, str]) -> dict[str, object]:
    """What the command line says of the recording of a run."""
    command = [*RTHM, "energy", str(folder / "bag"), "--json", "-"]
    return json.loads(subprocess.run(command, env=environment, check=True, capture_output=True).stdout)


def await_file(file: Path, seconds: float = 60.0) -> dict[str, object]:
    deadline = time.monotonic() + seconds
    while not file.exists() and time.monotonic() < deadline:
        time.sleep(0.1)
    return json.loads(file.read_text())


def test_the_energy_balance_published_in_a_run_is_that_of_its_recording(out: Path) -> None:
    recording = read_recording(out / "bag")
    published, counted = recording.tables["energy"], energy_of(recording, None)
    assert len(published) > 5
    rows = np.searchsorted(counted.t, recording.seconds(published.stamp_ns) - 1e-7)
    for term in TERMS:
        np.testing.assert_allclose(
            published.columns("effort", [term])[:, 0], counted.work[term][rows], rtol=0.0, atol=1e-9
        )
    assert rows[-1] == counted.t.size - 1


def test_a_recording_that_the_parameter_names_is_analysed_as_on_the_command_line(
    out: Path, environment: dict[str, str]
) -> None:
    written = out / "bag.energy.json"
    written.unlink(missing_ok=True)
    with analysis(environment, "-p", f"bag:={out / 'bag'}"):
        assert await_file(written) == energies(out, environment)


def test_the_service_analyses_the_recording_and_tells_the_verdict(
    out: Path, environment: dict[str, str], network: Network
) -> None:
    written = out / "bag.energy.json"
    with analysis(environment), Conductor(lambda: None, network.domain) as conductor:
        conductor.wait_for(["analysis"], 60.0)
        assert conductor.trigger("analysis", "run", 60.0) == (
            False,
            "no recording is known: set the parameter bag.",
        )
        conductor.set({"analysis": {"bag": str(out / "nothing")}})
        worked, words = conductor.trigger("analysis", "run", 60.0)
        assert not worked
        assert "does not exist" in words
        conductor.set({"analysis": {"bag": str(out / "bag")}})
        written.unlink(missing_ok=True)
        worked, words = conductor.trigger("analysis", "run", 60.0)
        assert worked
        assert "Position cancellation drained" in words
        assert json.loads(written.read_text()) == energies(out, environment)
        conductor.wait_until(
            lambda: "/rthm/analysis: verdict" in conductor.diagnostics, 10.0, lambda: "no verdict"
        )
        assert "Equivalent damping" in conductor.diagnostics["/rthm/analysis: verdict"]
