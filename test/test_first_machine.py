"""The page for a first machine, followed step by step with the emulated device."""

from __future__ import annotations

import os
import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.recording import read_recording
from rthm_bringup.run.environment import Network
from rthm_core.spec import apply, spec_at, write_spec

pytestmark = [pytest.mark.graph, pytest.mark.usefixtures("nothing_left")]
ROOT = Path(__file__).parents[1]
BLOCK = re.compile(r"^```console\n(.*?)^```$", re.DOTALL | re.MULTILINE)
PUNCTUAL = {"period jitter", "clock grid", "arrives in time"}
"""What a busy machine may not do."""


def commands() -> list[str]:
    """Every command of the page."""
    blocks = BLOCK.findall((ROOT / "docs" / "first_machine.md").read_text(encoding="utf-8"))
    return [line.removeprefix("$ ") for block in blocks for line in block.splitlines() if line[:2] == "$ "]


@pytest.mark.long
def test_the_page_for_a_first_machine_can_be_followed(
    environment: dict[str, str], network: Network, tmp_path: Path
) -> None:
    rig = apply(spec_at(ROOT / "examples" / "rig.yaml"), {"limits.stale": 0.5, "limits.heartbeat": 1.0})
    (tmp_path / "rig.yaml").write_text(write_spec(rig))
    for name, words in (("rthm", "-m rthm_bringup"), ("python", "")):
        (tmp_path / name).write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} {words} "$@"\n')
        (tmp_path / name).chmod(0o755)
    variables = environment | {"PATH": os.pathsep.join([str(tmp_path), environment.get("PATH", os.defpath)])}
    running = []
    try:
        for command in commands():
            if command.endswith("&"):
                words = shlex.split(command.removesuffix("&"))
                words[0] = str(tmp_path / words[0])
                running.append(subprocess.Popen(words, cwd=tmp_path, env=variables))
                continue
            done = subprocess.run(
                command, shell=True, cwd=tmp_path, env=variables, capture_output=True, text=True, check=False
            )
            if "check-driver" in command and "--measure" not in command:
                assert_conforms(done.stdout)
            else:
                assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"
            if command.startswith("python -c"):
                assert done.stdout == "True\n"
    finally:
        for process in running:
            process.send_signal(signal.SIGTERM)
        for process in running:
            process.wait()
    assert len(running) == 2
    measured = spec_at(tmp_path / "measured.yaml")
    assert measured.k_tot == pytest.approx(rig.k_tot, rel=0.01)
    assert measured.zero is not None and measured.zero.force == pytest.approx([0.0], abs=1e-6)
    travel = {stage: np.ptp(positions(tmp_path / stage / "bag")) for stage in ("dry", "small", "full")}
    assert travel["dry"] == 0.0
    assert 0.02 < travel["full"] < 0.4
    assert 0.02 < travel["small"] / travel["full"] < 0.3


def positions(bag: Path) -> np.ndarray:
    """Motor positions of a recording."""
    return read_recording(bag).plant.columns("position", ["a1"])


def assert_conforms(told: str) -> None:
    """Every check is passed but those that only a machine of one's own can promise."""
    lines = [re.match(r"(passed|FAILED) +(.+?): ", line) for line in told.splitlines()]
    checks = {line[2]: line[1] for line in lines if line}
    assert len(checks) > 8, told
    assert {name for name, verdict in checks.items() if verdict == "FAILED"} <= PUNCTUAL, told
