"""Runs with a rig of somebody else: as processes, with what they told at their end."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.hosts import command_on

from rthm_analysis.recording import Recording, read_recording

RTHM = [sys.executable, "-m", "rthm_bringup"]


def virtual_bag(spec: Path, duration: float) -> Path:
    """Bag of a run of the node graph in simulated time; its folder is made beside the spec.

    Raises
    ------
    RuntimeError
        What the run said, if there is no recording.
    """
    words = ["run", str(spec), "--virtual", "--duration", str(duration), "--out", str(spec.with_name("out"))]
    done = subprocess.run([*RTHM, *words, "--json", "-"], capture_output=True, text=True, check=False)
    if not done.stdout:
        raise RuntimeError(done.stderr)
    return Path(json.loads(done.stdout)["bag"])


@dataclass
class Told:
    """A run that is over: its status, its JSON, its output, what it said beside it, and its recording."""

    status: int
    json: dict[str, Any]
    out: str
    notes: str

    @property
    def recording(self) -> Recording:
        """Its bag."""
        return read_recording(self.json["bag"])

    @property
    def page(self) -> str:
        """Text of its report."""
        return Path(self.json["report"]).read_text()


class Runs:
    """Runs of one environment, one at a time, in one folder.

    Parameters
    ----------
    environment, folder
        Variables of all processes, and where everything is written.
    host
        Network namespace of the leader (`benchmarks.hosts`); empty: this one.
    """

    def __init__(self, environment: dict[str, str], folder: Path, host: str = "") -> None:
        self.environment, self.folder, self.host = environment, folder, host

    @contextmanager
    def begun(
        self, spec: Path, *options: str, keyboard: int | None = None
    ) -> Iterator[tuple[subprocess.Popen[str], Callable[[], Told]]]:
        """A run as a process, and what ends it."""
        json_file = self.folder / "result.json"
        command = [*RTHM, "run", str(spec), "--out", str(self.folder / "out"), "--json", str(json_file)]
        command = command_on(self.host, command) if self.host else command
        with subprocess.Popen(
            [*command, *options],
            env=self.environment,
            stdin=keyboard,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        ) as run:

            def ended() -> Told:
                out, notes = run.communicate(timeout=300)
                assert json_file.exists() or run.returncode < 0, out + notes
                told = json.loads(json_file.read_text()) if json_file.exists() else {}
                return Told(run.returncode, told, out, notes)

            try:
                yield run, ended
            finally:
                run.kill()

    def wait_until_it_moves(self, run: subprocess.Popen[str], size: int = 60_000) -> None:
        """Wait for some recording."""
        deadline = time.monotonic() + 240
        bag = self.folder / "out" / "bag"
        while sum(file.stat().st_size for file in bag.glob("*.mcap")) < size and run.poll() is None:
            assert time.monotonic() < deadline
            time.sleep(0.05)


def processes_in(domain: int) -> list[str]:
    """Command lines of the processes of this project in a domain."""
    found = []
    for folder in Path("/proc").iterdir():
        if not folder.name.isdigit() or int(folder.name) == os.getpid():
            continue
        try:
            command, variables = (folder / "cmdline").read_bytes(), (folder / "environ").read_bytes()
        except OSError:
            continue
        if b"rthm" in command and f"ROS_DOMAIN_ID={domain}".encode() in variables.split(b"\0"):
            found.append(command.replace(b"\0", b" ").decode())
    return found


def process(run: subprocess.Popen[str], module: str) -> int:
    """Process id of a node of the run."""
    for child in Path(f"/proc/{run.pid}/task/{run.pid}/children").read_text().split():
        if module.encode() in Path(f"/proc/{child}/cmdline").read_bytes():
            return int(child)
    raise AssertionError(f"{module} does not run")
