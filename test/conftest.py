"""What the tests of the whole system share: a domain of their own, and what is left behind."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from benchmarks.hosts import NoHostsError
from benchmarks.hosts import hosts as made_hosts
from benchmarks.rigs import processes_in
from benchmarks.stalls import Stalls

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
def hosts(request: pytest.FixtureRequest) -> Iterator[tuple[str, ...]]:
    """Names of network namespaces that reach each other: two, or as many as the parameter says."""
    try:
        with made_hosts(getattr(request, "param", 2)) as names:
            yield names
    except NoHostsError as error:
        pytest.skip(str(error))


@pytest.fixture
def host_stalls() -> Iterator[Callable[[float], float]]:
    """How long this machine let a thread with real-time priority wait in the last so many seconds, s."""
    with Stalls() as stalls:
        yield stalls.last


@pytest.fixture
def own_processes(network: Network) -> Callable[[], list[str]]:
    """Command lines of the processes of this project in the domain of the test."""
    return lambda: processes_in(network.domain)
