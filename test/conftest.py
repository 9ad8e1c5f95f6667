"""What the tests of the whole system share: a domain of their own, and what is left behind."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from hosts import two_hosts

from rthm_bringup.run import shared_memory
from rthm_bringup.run.domain import Claim
from rthm_bringup.run.environment import Network, has_wheels, without_parents_ros


@pytest.fixture
def network() -> Iterator[Network]:
    """A domain that nobody else on this host uses."""
    claim = Claim()
    yield Network(claim.domain)
    claim.release()


@pytest.fixture
def environment(network: Network, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """Environment for processes of the test, this one included."""
    variables = network.variables() | {"ROS_LOG_DIR": str(tmp_path / "ros_log")}
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    return without_parents_ros(os.environ, has_wheels())


@pytest.fixture
def nothing_left(network: Network) -> Iterator[None]:
    """Fail when a test leaves processes in its domain, or shared memory without an owner."""
    before = segments()
    yield
    assert processes_in(network.domain) == []
    deadline = time.monotonic() + 10.0
    while not segments() <= before and time.monotonic() < deadline:
        time.sleep(0.2)  # those of a test beside this one are removed at its end
    assert segments() <= before


def segments() -> set[str]:
    """Shared memory without an owner; ports are left out, as all domains of a host share their names."""
    return {name for name in shared_memory.abandoned() if "_port" not in name}


@pytest.fixture
def hosts() -> Iterator[tuple[str, str]]:
    """Names of two network namespaces that reach each other."""
    with two_hosts() as names:
        yield names


@pytest.fixture
def held_up() -> Iterator[Callable[[float], float]]:
    """How long this machine let a thread with real-time priority wait in the last so many seconds, s."""
    waits, over = [(time.monotonic(), 0.0)], threading.Event()

    def watch() -> None:
        with suppress(OSError):
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(90))
        while not over.is_set():
            due = time.monotonic() + 0.005
            time.sleep(0.005)
            waits.append((due, time.monotonic() - due))

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    yield lambda seconds: sum(wait for at, wait in waits.copy() if at > time.monotonic() - seconds)
    over.set()
    watcher.join()


@pytest.fixture
def own_processes(network: Network) -> Callable[[], list[str]]:
    """Command lines of the processes of this project in the domain of the test."""
    return lambda: processes_in(network.domain)


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
