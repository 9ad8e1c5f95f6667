"""How faults are made: what each needs before the test, and what it does to the running one."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

from benchmarks.faults.laboratory import OPERATOR, RIVAL, Laboratory
from benchmarks.hosts import plug
from benchmarks.rigs import RTHM, process

NOWHERE = subprocess.DEVNULL
MODULES = {
    "plant": "rthm_plant_sim",
    "numerical": "rthm_numerical",
    "controller": "rthm_actuator",
    "recorder": "recorder_node",
    "analysis": "rthm_analysis",
}
"""What is in the command line of each part of a run."""


@dataclass
class Running:
    """A test that runs.

    Attributes
    ----------
    laboratory, run, driver
        Where it runs, its leader, and the driver if the plant is not simulated.
    hosts
        Where they are, the leader first; none: on this one.
    struck
        When the fault began, ns of the wall clock; None: its driver knows.
    beside
        What was prepared for the fault, if anything was.
    ends
        Undoes what the fault did, when the test is over.
    complaints
        What happened beside the test that should not have.
    """

    laboratory: Laboratory
    run: subprocess.Popen[str]
    driver: subprocess.Popen[bytes] | None
    hosts: tuple[str, ...] = ()
    struck: int | None = None
    beside: subprocess.Popen[bytes] | None = None
    ends: ExitStack = field(default_factory=ExitStack)
    complaints: list[str] = field(default_factory=list)

    def pid(self, part: str) -> int:
        """Process id of a part."""
        if part == "leader":
            return self.run.pid
        if part == "driver":
            assert self.driver is not None
            return self.driver.pid
        return process(self.run, MODULES[part])


class Way:
    """How a fault is made.

    Attributes
    ----------
    driver
        Arguments of the driver.
    options
        Of ``rthm run``.
    simulated
        Whether the plant is the simulated one.
    hosts
        Whether the driver is on a host of its own.
    lasting
        How long it lasts, s.
    gone
        The part that is gone afterwards; empty: none is.
    forged
        Where somebody else commands the motor to be, m; None: nobody does.
    dated
        Whether it is known when it begins: what a full disk or a lack of memory does shows later.
    duration
        Length of a test that goes on in spite of it, s.
    """

    driver: tuple[str, ...] = ()
    options: tuple[str, ...] = ()
    simulated: ClassVar[bool] = False
    hosts: ClassVar[bool] = False
    lasting: float = float("inf")
    gone: str = ""
    forged: float | None = None
    dated: ClassVar[bool] = True
    duration: ClassVar[float] = 8.0

    @contextmanager
    def prepared(self, laboratory: Laboratory) -> Iterator[subprocess.Popen[bytes] | None]:
        """Do what has to be done before the test begins, and undo it after its end."""
        yield None

    def strike(self, test: Running) -> None:
        """Do it to a running test."""


@dataclass(frozen=True)
class Spoiled(Way):
    """The driver's samples are spoiled 1.5 s after its first command."""

    name: str
    lasting: float = float("inf")

    @property
    def driver(self) -> tuple[str, ...]:  # type: ignore[override]
        """Arguments of the driver."""
        return self.name, "1.5", str(self.lasting)


@dataclass(frozen=True)
class Sent(Way):
    """A process gets a signal; one that is stopped may go on after `lasting`."""

    part: str
    number: signal.Signals
    lasting: float = float("inf")

    @property
    def simulated(self) -> bool:  # type: ignore[override]
        """Whether the plant is the simulated one."""
        return self.part == "plant"

    @property
    def gone(self) -> str:  # type: ignore[override]
        """The part; one whose beat the leader has missed is not waited for."""
        return self.part

    def strike(self, test: Running) -> None:
        """Send it."""
        pid = test.pid(self.part)
        test.struck = time.time_ns()
        os.kill(pid, self.number)
        if self.lasting < float("inf"):
            time.sleep(self.lasting)
            with suppress(ProcessLookupError):  # its leader has not waited for it
                os.kill(pid, signal.SIGCONT)


@dataclass(frozen=True)
class Rival(Way):
    """A second publisher of a topic appears."""

    topic: str

    @property
    def forged(self) -> float | None:  # type: ignore[override]
        """Where a second publisher of commands wants the motor, m."""
        return 9.0 if self.topic == "actuator/command" else None

    def strike(self, test: Running) -> None:
        """Start it; the fault begins with the first of its samples that somebody can hear."""
        command = [sys.executable, str(RIVAL), self.topic, "60"]
        rival = subprocess.Popen(
            command, env=test.laboratory.environment, stdout=NOWHERE, stderr=subprocess.PIPE, text=True
        )
        test.ends.callback(rival.communicate)
        test.ends.callback(rival.terminate)
        assert rival.stderr is not None
        said = next((line for line in rival.stderr if line.startswith("heard from")), None)
        test.struck = int(said.split()[-1]) if said else None


@dataclass(frozen=True)
class SecondRun(Way):
    """Somebody starts another run in the same domain."""

    duration: ClassVar[float] = 25.0

    def strike(self, test: Running) -> None:
        """Start it, and see that it is refused in one sentence."""
        test.struck = time.time_ns()
        out = test.laboratory.folder / "second"
        command = [*RTHM, "run", "paper", "--virtual", "--duration", "1", "--out", str(out)]
        environment = test.laboratory.environment
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        if done.returncode != 2 or done.stderr.count("\n") != 1 or out.exists():
            test.complaints.append(f"the second run ended with status {done.returncode}: {done.stderr}")


@dataclass(frozen=True)
class Operator(Way):
    """An operator aborts the test, by his way, or leaves it, where his way is the heartbeat."""

    way: str

    @property
    def options(self) -> tuple[str, ...]:  # type: ignore[override]
        """Of ``rthm run``."""
        return ("--heartbeat",) if self.way == "heartbeat" else ()

    @contextmanager
    def prepared(self, laboratory: Laboratory) -> Iterator[subprocess.Popen[bytes]]:
        """Have an operator."""
        command = [sys.executable, str(OPERATOR), self.way]
        with subprocess.Popen(command, env=laboratory.environment, stdout=subprocess.DEVNULL) as operator:
            yield operator
            operator.terminate()

    def strike(self, test: Running) -> None:
        """Ask him."""
        assert test.beside is not None
        test.struck = time.time_ns()
        test.beside.terminate()


@dataclass(frozen=True)
class Cable(Way):
    """The cable between the controller's host and the driver's is pulled."""

    lasting: float
    hosts: ClassVar[bool] = True

    def strike(self, test: Running) -> None:
        """Pull it, and put it back."""
        test.struck = time.time_ns()
        plug(test.hosts[1], "down")
        time.sleep(self.lasting)
        plug(test.hosts[1], "up")


@dataclass(frozen=True)
class Disk(Way):
    """The disk for the recording is full after some bytes, which come soon."""

    size: int
    dated: ClassVar[bool] = False

    @contextmanager
    def prepared(self, laboratory: Laboratory) -> Iterator[None]:
        """Give the run a small disk of its own."""
        out = laboratory.folder / "out"
        out.mkdir()
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={self.size}", "tmpfs", out], check=True)
        try:
            yield None
        finally:
            subprocess.run(["umount", "-l", out], check=True)

    def strike(self, test: Running) -> None:
        """Wait until nothing is left."""
        out = test.laboratory.folder / "out"
        while os.statvfs(out).f_bavail > 0 and test.run.poll() is None:
            time.sleep(0.002)
        test.struck = time.time_ns()


@dataclass(frozen=True)
class Memory(Way):
    """A process gets no more memory than it has."""

    part: str
    dated: ClassVar[bool] = False

    @property
    def gone(self) -> str:  # type: ignore[override]
        """The part."""
        return self.part

    def strike(self, test: Running) -> None:
        """Limit it."""
        pid = test.pid(self.part)
        pages = int(Path(f"/proc/{pid}/statm").read_text().split()[0])
        _, hard = resource.prlimit(pid, resource.RLIMIT_AS)
        test.struck = time.time_ns()
        resource.prlimit(pid, resource.RLIMIT_AS, (pages * resource.getpagesize(), hard))
