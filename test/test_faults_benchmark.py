"""The judge of faults: what it measures and what it complains of, on outcomes made by hand."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from signal import SIGKILL, SIGSTOP

import numpy as np
import pytest
from benchmarks.faults.catalogue import FAULTS, PARTS, Fault
from benchmarks.faults.judge import Case, Outcome, judged
from benchmarks.faults.laboratory import PATIENT, RAMP, RATE, STANDS, STRICT, DriverLog
from benchmarks.faults.measure import Figures, largest_speed, largest_step, last_move
from benchmarks.faults.page import markdown
from benchmarks.faults.ways import Sent
from benchmarks.rigs import Told
from benchmarks.stalls import Stalls

from rthm_analysis.recording import Recording, Table
from rthm_core.clock import NS

BY_NAME = {fault.name: fault for fault in FAULTS}
MS = NS // 1000
GOOD = Figures(0.4, 1.0, 10 * NS + int(RAMP * NS), 0.0, 10 * NS, ("json", "page", "bag"))
"""Of a sensor that is wrong at 10 s: at rest a ramp later."""
ABORT = {"at": 10.0, "limit": "finite", "words": "the force sensor of a1 reads not a number since 10.000 s"}


def recording(stamp_ms: list[float], sent_ms: list[float], u_d: list[float]) -> Recording:
    stamps, sent = (np.array([round(ms * MS) for ms in times]) for times in (stamp_ms, sent_ms))
    values = np.array(u_d)[:, None]
    table = Table(stamps, sent, sent, ("a1",), values, values, values)
    return Recording(Path(), "/rthm", None, "", {"actuator/command": table}, {}, 0, ())


def outcome(fault: Fault, figures: Figures, status: int = 3, **abort: object) -> Outcome:
    told = Told(status, {"abort": ABORT | abort, "problems": []}, "", "")
    return judged(Case(fault, PATIENT, 10 * NS, Stalls()), told, figures, [], DriverLog([]))


def test_a_step_at_the_rate_is_one_and_a_burst_in_real_time_is_more() -> None:
    stamps, u_d = [0.0, 4.0, 8.0, 12.0], [STANDS, STANDS + 0.02, STANDS + 0.03, STANDS + 0.05]
    assert largest_step(recording(stamps, stamps, u_d), RATE) == pytest.approx(1.0)
    assert largest_step(recording(stamps, [0.0, 4.0, 4.1, 4.2], u_d), RATE) > 5.0


def test_the_first_command_steps_from_where_the_motor_stands() -> None:
    assert largest_step(recording([0.0], [0.0], [STANDS + 0.04]), RATE) == pytest.approx(2.0)


def test_the_speed_of_the_motor_counts_where_it_moved() -> None:
    log = DriverLog([(0.0, 0.1), (1.0, 0.1), (1.004, 0.11), (1.0041, 0.11), (1.009, 0.12)])
    assert largest_speed(log) == pytest.approx(2.5)
    assert last_move(*np.transpose(log.moves)) == (1.009, pytest.approx(0.02))
    assert last_move(np.array([0.0, 1.0]), np.array([0.1, 0.1])) == (None, 0.0)


def test_a_test_that_ends_as_demanded_is_not_complained_of() -> None:
    found = outcome(BY_NAME["nan"], GOOD)
    assert found.complaints == ()
    assert found.rest == pytest.approx(RAMP)
    assert not found.disturbed


@pytest.mark.parametrize(
    ("figures", "changed", "complaint"),
    [
        (GOOD, {"limit": "stale"}, "limit is stale, must be finite"),
        (GOOD, {"words": "something"}, "nothing says"),
        (GOOD, {"status": 0}, "status is 0, must be 3"),
        (replace(GOOD, step=1.01), {}, "command step"),
        (replace(GOOD, speed=5.1), {}, "speed of the motor is 5.1, allowed is 5"),
        (replace(GOOD, rested=11 * NS), {}, "time to rest is 1, allowed is 0.6"),
        (replace(GOOD, left=0.01), {}, "distance from where the motor stood is 0.01"),
        (replace(GOOD, told=("json", "page")), {}, "the abort is not in the bag"),
    ],
)
def test_everything_that_is_not_as_demanded_is_complained_of(
    figures: Figures, changed: dict[str, object], complaint: str
) -> None:
    complaints = outcome(BY_NAME["nan"], figures, **changed).complaints  # type: ignore[arg-type]
    assert any(complaint in one for one in complaints), complaints


def test_a_test_that_ended_before_its_fault_says_nothing_of_it() -> None:
    assert outcome(BY_NAME["nan"], replace(GOOD, aborted=9 * NS)).disturbed


def test_a_fault_that_is_shorter_than_what_is_allowed_is_none() -> None:
    assert BY_NAME["silent-0.1"].expected(STRICT)[:2] == (("stale",), 3)
    assert BY_NAME["silent-0.1"].expected(PATIENT) == ((), 1, "samples are missing")
    assert BY_NAME["cable-0.1"].expected(PATIENT)[0] == ("stale",)  # it has a limit of its own
    assert BY_NAME["controller-late"].expected(STRICT) == ((), 0, "")


def test_every_part_is_killed_and_stopped() -> None:
    sent = {(fault.way.part, fault.way.number) for fault in FAULTS if isinstance(fault.way, Sent)}
    assert sent == {(part, number) for part in PARTS for number in (SIGKILL, SIGSTOP)}
    assert len(BY_NAME) == len(FAULTS)


def test_the_page_lists_every_fault_with_its_complaints() -> None:
    rows = [asdict(outcome(fault, GOOD)) | {"load": 1.0, "attempts": 1} for fault in FAULTS]
    rows[0] |= {"attempts": 2}
    header = {"date": "2026-11-23", "machine": "this one", "load": "1.0"} | STRICT
    page = markdown(header, rows)
    assert all(f"| {fault.what} |" in page for fault in FAULTS)
    assert "**limit is finite, must be step" in page
    assert "that happened to nan (2)." in page
