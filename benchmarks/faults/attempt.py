"""One test with one fault."""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from benchmarks.faults.catalogue import Fault
from benchmarks.faults.judge import Case, Outcome, judged
from benchmarks.faults.laboratory import RATE, Laboratory
from benchmarks.faults.measure import measure, recorded
from benchmarks.faults.ways import Running
from benchmarks.hosts import ADDRESSES
from benchmarks.rigs import Told, processes_in
from benchmarks.stalls import Stalls

from rthm_bringup.run.domain import Claim
from rthm_bringup.run.environment import PROFILES, RANGE, Network, has_wheels, without_parents_ros
from rthm_core.clock import NS
from rthm_core.ros.reach import PEERS, VARIABLE

LONG_ENOUGH = 30.0
"""Length of a test that its fault ends, s."""
MOVING = 200_000
"""Size of the recording at which the fault may come, bytes."""
PRIORITY = 10
"""Real-time priority of the driver, with which stalls of the machine are measured."""
CLOSING = (PROFILES, RANGE, VARIABLE, PEERS, "SKIP_DEFAULT_XML_FILE")
"""Variables that close a test to other hosts."""


@contextmanager
def own_domain(folder: Path) -> Iterator[dict[str, str]]:
    """Environment of processes in a domain that nobody else uses."""
    claim = Claim()
    variables = Network(claim.domain).variables() | {"ROS_LOG_DIR": str(folder / "ros_log")}
    try:
        yield without_parents_ros(os.environ | variables, has_wheels())
    finally:
        claim.release()


def attempt(fault: Fault, laboratory: Laboratory, hosts: tuple[str, ...] = ()) -> Outcome:
    """Run a test, make the fault, and judge how it ended.

    Parameters
    ----------
    fault
        Entry of the catalogue.
    laboratory
        Where it runs.
    hosts
        Leader's and driver's, for faults of the cable between them.
    """
    with fault.way.prepared(laboratory) as beside:
        with Stalls(PRIORITY) as stalls:
            told, test = _run(fault, laboratory, hosts, beside)
        log = laboratory.driver_log()
        bag = recorded(told, laboratory.folder / "out" / "bag", fault.way.forged)
        figures = measure(told, bag, log, RATE, bool(hosts) or fault.way.gone == "driver")
    struck = test.struck if log is None or log.struck is None else round(log.struck * NS)
    case = Case(fault, laboratory.limits, struck, stalls)
    return judged(case, told, figures, test.complaints, log)


def _run(
    fault: Fault, laboratory: Laboratory, hosts: tuple[str, ...], beside: subprocess.Popen[bytes] | None
) -> tuple[Told, Running]:
    """Let a test run, with its fault, until everything of it is gone."""
    way, spec = fault.way, laboratory.spec(**fault.given)
    ours, theirs, options = _environments(laboratory.environment, hosts)
    laboratory.environment = ours
    options += [*way.options, *(() if way.simulated else ("--plant", "external"))]
    ends_it = fault.expected(laboratory.limits)[0]
    options += ["--duration", f"{LONG_ENOUGH if ends_it else way.duration:g}"]
    at = hosts[1] if hosts else ""
    with ExitStack() as ends:
        driver = None
        if not way.simulated:
            driver = ends.enter_context(laboratory.driver(*way.driver, host=at, environment=theirs))
        run, ended = ends.enter_context(laboratory.begun(spec, *options))
        test = Running(laboratory, run, driver, hosts, beside=beside, ends=ends)
        laboratory.wait_until_it_moves(run, MOVING)
        if run.poll() is None:  # else a busy machine has ended the test before its fault
            way.strike(test)
        told = ended()
        _wait_for_the_last(int(ours["ROS_DOMAIN_ID"]))
    return told, test


def _environments(
    environment: dict[str, str], hosts: tuple[str, ...]
) -> tuple[dict[str, str], dict[str, str], list[str]]:
    """Environments of the leader and of the driver, and what the leader is told of the driver's host."""
    if not hosts:
        return environment, environment, []
    plain = {name: value for name, value in environment.items() if name not in CLOSING}
    there = plain | {PEERS: ADDRESSES[0], RANGE: "SUBNET"}
    return plain, there, ["--peers", ADDRESSES[1]]


def _wait_for_the_last(domain: int) -> None:
    """Wait until nobody of a test is left, whose leader may have been killed."""
    deadline = time.monotonic() + 30.0
    while processes_in(domain) and time.monotonic() < deadline:
        time.sleep(0.05)
