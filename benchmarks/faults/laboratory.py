"""A driver of somebody else that stands at 0.1 m, and runs with it."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.hosts import command_on
from benchmarks.rigs import Runs, Told

from rthm_core.spec import LimitsSpec, shipped_spec, write_spec

PROGRAMS = Path(__file__).parents[2] / "test" / "programs"
DRIVER, OPERATOR, RIVAL = (PROGRAMS / f"{name}.py" for name in ("driver", "operator", "rival"))
STANDS = 0.1
"""Where the motor stands, m."""
RATE, RAMP = 5.0, 0.5
LIMITS = {"command": 1.0, "rate": RATE, "force": 50.0, "ramp": RAMP, "start": (0.02, 1.0)}
"""The motor of the spec stands 15 mm away from this driver's."""
STRICT = LIMITS | {"stale": 0.08, "heartbeat": 0.2}
PATIENT = LIMITS | {"stale": 0.5, "heartbeat": 0.8}
"""On a busy machine: a sample that it holds up is not called stale."""


@dataclass
class DriverLog:
    """What a driver leaves behind.

    Attributes
    ----------
    moves
        Instants, s of the wall clock, and where the motor went then, m.
    struck
        When its fault began, s of the wall clock; None: never.
    refused, held_back
        Commands that it did not execute for their age, and those that it executed in part for their rate.
    """

    moves: list[tuple[float, float]]
    struck: float | None = None
    refused: int = 0
    held_back: int = 0


class Laboratory(Runs):
    """A driver at 0.1 m, and a run with it.

    Parameters
    ----------
    environment, folder, host
        As in `Runs`.
    limits
        Those of the spec where a test gives none.
    """

    def __init__(
        self, environment: dict[str, str], folder: Path, host: str = "", limits: dict[str, Any] = PATIENT
    ) -> None:
        super().__init__(environment, folder, host)
        self.limits = limits

    def spec(self, begins: float = STANDS, **limits: Any) -> Path:
        """A spec whose plant begins somewhere; a limit of None is left out."""
        paper = shipped_spec()
        plant = paper.plant.model_copy(update={"initial_position": (begins,)})
        given = self.limits | limits
        kept = LimitsSpec(**{name: value for name, value in given.items() if value is not None})
        file = self.folder / "rig.yaml"
        file.write_text(write_spec(paper.model_copy(update={"plant": plant, "limits": kept})))
        return file

    @contextmanager
    def driver(
        self, *fault: str, host: str = "", environment: dict[str, str] | None = None
    ) -> Iterator[subprocess.Popen[bytes]]:
        """The driver as a process, on a host of its own where one is named."""
        words = [sys.executable, DRIVER, "600", STANDS, *fault]
        command = command_on(host, words) if host else [str(word) for word in words]
        variables = (environment or self.environment) | {"DRIVER_LOG": str(self._log)}
        with subprocess.Popen(command, env=variables) as driver:
            try:
                yield driver
            finally:
                driver.send_signal(signal.SIGCONT)
                driver.terminate()

    def driver_log(self) -> DriverLog | None:
        """What the driver has left behind; None if it could not."""
        if not self._log.exists():
            return None
        told = json.loads(self._log.read_text())
        moves = [(float(at), float(u)) for at, u in told["moves"]]
        return DriverLog(moves, told["struck"], told["refused"], told["held back"])

    @property
    def _log(self) -> Path:
        return self.folder / "driver.json"

    def run(self, spec: Path, *options: str, fault: Sequence[str] = ()) -> Told:
        """A run with the driver, from its begin to its end."""
        with self.driver(*fault), self.begun(spec, "--plant", "external", *options) as (_, ended):
            return ended()
