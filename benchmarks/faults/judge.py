"""Figures of a test with a fault beside what is demanded."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from benchmarks.faults.catalogue import Fault
from benchmarks.faults.laboratory import RAMP, RATE, DriverLog
from benchmarks.faults.measure import Figures
from benchmarks.rigs import Told
from benchmarks.stalls import Stalls

from rthm_core.clock import NS
from rthm_core.limits import FROZEN, HOLD

DETECTION = {"stale": "stale", "age": "stale", "owner": "stale", "heartbeat": "heartbeat"}
"""Which limit of the spec is the time in which a limit has to be seen broken; others are seen at once."""
FIXED = {"frozen": FROZEN, "hold": HOLD}
"""The same where it is a default, s."""
MARGIN = 0.1
"""What is allowed beyond detection and ramp, s."""
STALL = 0.001
"""Shortest stall of the machine that is subtracted, s."""
TOLERATED = 0.2
"""How long the machine may stand still in all while a fault is judged, s."""
ROUNDING = 1e-9


@dataclass(frozen=True)
class Case:
    """A fault as it was made.

    Attributes
    ----------
    fault, limits
        Entry of the catalogue, and limits of the laboratory.
    struck
        When it began, ns of the wall clock; None: it never did.
    stalls
        How the host stalled meanwhile.
    """

    fault: Fault
    limits: Mapping[str, Any]
    struck: int | None
    stalls: Stalls


@dataclass(frozen=True)
class Outcome:
    """How a test with a fault ended.

    Attributes
    ----------
    name
        Of the fault.
    status, limit, words
        Exit status, the limit that ended it, and what was said.
    step, speed
        Of `Figures`.
    rest, allowed, stalled
        Time from the fault, or from the abort where the fault has no date, to the last move; what is
        allowed; and how long the host stalled within it, which is allowed, too; s.
    told
        Where the abort is told.
    refused, held_back
        Of the driver.
    complaints
        What is not as it must be; none: all is.
    disturbed
        Whether the test ended before the fault, or the host stalled: it says nothing about the fault.
    """

    name: str
    status: int
    limit: str | None
    words: str
    step: float | None
    speed: float | None
    rest: float | None
    allowed: float | None
    stalled: float
    told: tuple[str, ...]
    refused: int | None
    held_back: int | None
    complaints: tuple[str, ...]
    disturbed: bool


def judged(case: Case, told: Told, figures: Figures, complaints: list[str], log: DriverLog | None) -> Outcome:
    """Judge a test that is over."""
    abort, fault = told.json.get("abort"), case.fault
    limit = abort["limit"] if abort else None
    rest, allowed, stalled = _rest(case, figures, limit)
    words = _words(told)
    limits, status, part = fault.expected(case.limits)
    found = [
        *complaints,
        *_unlike("limit", limit, limits or (None,)),
        *_unlike("status", told.status, (-9,) if status is None else (status,)),
        *([] if part in words else [f"nothing says {part!r}"]),
        *_beyond("command step over rate x time", figures.step, 1.0),
        *_beyond("speed of the motor", figures.speed, RATE),
        *_beyond("distance from where the motor stood", figures.left, None if _held(fault, limit) else 0.0),
        *_beyond("time to rest", rest, None if allowed is None else allowed + stalled),
        *(f"the abort is not in the {place}" for place in _silent(fault, limits, figures)),
    ]
    return Outcome(
        fault.name, told.status, limit, words, figures.step, figures.speed, rest, allowed, stalled,
        figures.told, *_driver(log), tuple(found), _disturbed(case, figures),
    )  # fmt: skip


def _disturbed(case: Case, figures: Figures) -> bool:
    """Whether the test ended before its fault, or the host stalled so long that it is in doubt."""
    if case.struck is None or (figures.aborted is not None and figures.aborted < case.struck - NS // 50):
        return True
    return case.stalls.within(case.struck, (figures.rested or case.struck) + NS, STALL) > TOLERATED


def _held(fault: Fault, limit: str | None) -> bool:
    """Whether nobody is left to bring the motor back, so that its driver holds it."""
    return fault.way.gone == "controller" and limit is not None


def _rest(case: Case, figures: Figures, limit: str | None) -> tuple[float | None, float | None, float]:
    """Time to rest, what is allowed, and stalls of the machine within it, s; None: the test went on."""
    begin = case.struck if case.fault.way.dated else figures.aborted
    killed = case.fault.status is None
    if begin is None or figures.rested is None or not (limit or killed):
        return None, None, 0.0
    kept = dict(case.limits) | dict(case.fault.given)
    seen = 0.0
    if case.fault.way.dated and limit is not None:
        seen = FIXED.get(limit) or float(kept.get(DETECTION.get(limit, ""), 0.0))
    rest = max(figures.rested - begin, 0) / NS
    return rest, seen + RAMP + MARGIN, case.stalls.within(begin, begin + round(rest * NS), STALL)


def _driver(log: DriverLog | None) -> tuple[int | None, int | None]:
    """What the driver did not execute, and what in part."""
    return (None, None) if log is None else (log.refused, log.held_back)


def _words(told: Told) -> str:
    """What was said of the fault, the first word first."""
    abort = told.json.get("abort")
    said = [abort["words"]] if abort else []
    return "; ".join(dict.fromkeys([*said, *told.json.get("problems", [])]))


def _unlike(what: str, value: object, allowed: tuple[object, ...]) -> list[str]:
    if value in allowed:
        return []
    return [f"{what} is {value}, must be {' or '.join(map(str, allowed))}"]


def _beyond(what: str, value: float | None, allowed: float | None) -> list[str]:
    if value is None or allowed is None or value <= allowed + ROUNDING:
        return []
    return [f"{what} is {value:.4g}, allowed is {allowed:.4g}"]


def _silent(fault: Fault, limits: tuple[str, ...], figures: Figures) -> list[str]:
    """Places where an abort is not told and must be."""
    must = {"json", "page", "bag"} - set(fault.unwritten) if limits else set()
    return sorted(must - set(figures.told))
