"""Runs with a rig of somebody else: as processes, with what they told at their end."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rthm_analysis.recording import Recording, read_recording

RTHM = [sys.executable, "-m", "rthm_bringup"]


@dataclass
class Told:
    """A run that is over: its status, its JSON, what it printed, and its recording."""

    status: int
    json: dict[str, Any]
    out: str

    @property
    def recording(self) -> Recording:
        return read_recording(self.json["bag"])

    @property
    def page(self) -> str:
        return Path(self.json["report"]).read_text()


class Runs:
    """Runs of one environment, one at a time, in one folder."""

    def __init__(self, environment: dict[str, str], folder: Path) -> None:
        self.environment, self.folder = environment, folder

    @contextmanager
    def begun(
        self, spec: Path, *options: str, keyboard: int | None = None
    ) -> Iterator[tuple[subprocess.Popen[str], Callable[[], Told]]]:
        """A run as a process, and what ends it."""
        json_file = self.folder / "result.json"
        command = [*RTHM, "run", str(spec), "--out", str(self.folder / "out"), "--json", str(json_file)]
        with subprocess.Popen(
            [*command, *options],
            env=self.environment,
            stdin=keyboard,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        ) as run:

            def ended() -> Told:
                said, _ = run.communicate(timeout=300)
                assert json_file.exists(), said
                return Told(run.returncode, json.loads(json_file.read_text()), said)

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
