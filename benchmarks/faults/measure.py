"""Figures of a test with a fault: command steps, speed of the motor, time to rest, and where it is told."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from benchmarks.faults.laboratory import STANDS, DriverLog
from benchmarks.rigs import Told

from rthm_analysis.recording import Recording, read_recording
from rthm_core.clock import NS
from rthm_core.errors import InputError

SENDING = NS // 2000
"""How unevenly a command that has been computed is sent, ns."""


@dataclass(frozen=True)
class Figures:
    """What is measured.

    Attributes
    ----------
    step
        Largest step of the command over `limits.rate` x the time since the last one; None: no recording.
    speed
        Largest speed of the motor as its driver moved it, m/s; None: nothing is known.
    rested
        When the motor moved for the last time, ns of the wall clock; None: not known.
    left
        How far the motor is from where it stood before the test, m; None: not known.
    aborted
        When the abort was told, ns of the wall clock; None: none was, or its recording is lost.
    told
        Where the abort is told: any of ``json``, ``page``, ``bag``.
    """

    step: float | None
    speed: float | None
    rested: int | None
    left: float | None
    aborted: int | None
    told: tuple[str, ...]


def measure(
    told: Told, bag: Recording | None, log: DriverLog | None, rate: float, commanded: bool
) -> Figures:
    """Measure a test that is over.

    Parameters
    ----------
    told, bag, log
        What the run told, its recording, and what the driver left behind, as far as they are there.
    rate
        The limit, m/s.
    commanded
        Whether the motor counts as where it is commanded, as its driver is gone or hears nothing.
    """
    abort = told.json.get("abort")
    commands = None if bag is None else bag.tables.get("actuator/command")
    aborted = None if abort is None or bag is None else bag.start_ns + round(abort["at"] * NS)
    rested, left = None, None
    if log is not None and not commanded:
        rested, left = last_move(*np.transpose(log.moves))
    elif commands is not None:
        rested, left = last_move(commands.sent_ns / NS, commands.columns("position", ["a1"])[:, 0])
    return Figures(
        None if bag is None or commands is None else largest_step(bag, rate, STANDS if log else None),
        None if log is None else largest_speed(log),
        None if rested is None else round(rested * NS),
        left,
        aborted,
        where_told(told, bag),
    )


def largest_step(recording: Recording, rate: float, stands: float | None = STANDS) -> float:
    """Largest step of the command over what `rate` allows for the time since the last one.

    The time counts between the stamps, or that really passed, whichever is less. The first command steps
    from where the motor stands, in one period; with `stands` None it is left out.
    """
    commands = recording.tables["actuator/command"]
    u_d = commands.columns("position", ["a1"])[:, 0]
    stamped, sent = (np.diff(times) for times in (commands.stamp_ns, commands.sent_ns))
    waits = np.minimum(stamped, np.maximum(sent, 0) + SENDING) / NS
    if stands is not None:
        u_d, waits = np.concatenate([[stands], u_d]), np.concatenate([[0.004], waits])
    steps = np.maximum(np.abs(np.diff(u_d)) - 1e-12, 0.0)
    return float(np.max(steps / (rate * waits), initial=0.0))


def largest_speed(log: DriverLog) -> float:
    """Largest speed at which a driver moved its motor, m/s."""
    at, u = np.transpose(log.moves)
    moved = np.diff(u) != 0.0
    return float(np.max(np.abs(np.diff(u)[moved]) / np.diff(at)[moved], initial=0.0))


def last_move(at: np.ndarray, u: np.ndarray) -> tuple[float | None, float]:
    """Instant of the last change of a position, s, None if there is none, and how far it has gone, m."""
    moved = np.flatnonzero(np.diff(u))
    return float(at[moved[-1] + 1]) if moved.size else None, float(abs(u[-1] - u[0]))


def where_told(told: Told, bag: Recording | None) -> tuple[str, ...]:
    """Where an abort is told."""
    places = []
    if told.json.get("abort"):
        places.append("json")
    if told.json.get("report") and "Aborted at" in told.page.partition("<h1>")[0]:
        places.append("page")
    if bag is not None and bag.abort is not None:
        places.append("bag")
    return tuple(places)


def recorded(told: Told, folder: Path, forged: float | None = None) -> Recording | None:
    """Recording of a test, if one is left, without commands of somebody else to the position `forged`, m."""
    try:
        bag = read_recording(told.json.get("bag") or folder)
    except InputError:
        return None
    commands = bag.tables.get("actuator/command")
    if forged is None or commands is None:
        return bag
    ours = np.flatnonzero(commands.columns("position", ["a1"])[:, 0] != forged)
    return replace(bag, tables=bag.tables | {"actuator/command": commands.rows(ours)})
