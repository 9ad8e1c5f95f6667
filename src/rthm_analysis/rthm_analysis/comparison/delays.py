"""Effective delays of one test: of every link, and of command to motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.comparison.lateness import Estimate
from rthm_analysis.identification.estimate import BLOCKS
from rthm_analysis.identification.evidence import motions_of
from rthm_analysis.identification.motor import DELAY, FAST, SLOW, fitted_motor
from rthm_analysis.recording.synchronised import synchronised
from rthm_analysis.timing import timing_of
from rthm_analysis.timing.links import clock_of, due_of
from rthm_core.clock import NS
from rthm_core.link import NEVER
from rthm_core.schedule import Schedule, newest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rthm_analysis.comparison.motion import Motion
    from rthm_analysis.identification.evidence import Motion as Actuated
    from rthm_analysis.recording import Recording
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec

FITTED = 20_000
"""Samples of a recording to which a motor is fitted at most: those of its liveliest stretch."""

SCHEDULED = 100
"""Hyperperiods of a schedule from which mean ages are taken."""

FEWEST_OF_A_MOTOR = 100
"""Samples that a fit of a motor takes at least."""


def delays_of(motion: Motion) -> dict[str, Estimate]:
    """Effective delays of a test, s.

    ``tau1`` to ``tau4``: mean age of the samples of a link at their use, holds of their source included; of a
    recording as they were, of a simulation as its schedule has them. ``a1.command to a1.motor``: delay and
    time constants of the motor together, from the stamps of its commands to its motion; of a recording.
    Empty for what tells neither.
    """
    spec = motion.spec
    if spec is None or not spec.is_loop:
        return {}
    if motion.recording is None:
        return {name: Estimate(age, 0.0) for name, age in _scheduled(spec)}
    return _recorded_links(motion.recording, spec) | _motors(motion.recording, spec)


def _recorded_links(recording: Recording, spec: Spec) -> dict[str, Estimate]:
    links = timing_of(recording, spec).links
    found = {name: _mean(link.age[np.isfinite(link.age)]) for name, link in links.items()}
    return {name: one for name, one in found.items() if np.isfinite(one.value)}


def _mean(ages: Floats) -> Estimate:
    """Mean of ages (n,), and its standard deviation from the means of stretches, which holds where
    neighbouring ages belong together.
    """
    if not ages.size:
        return Estimate(np.nan, np.nan)
    if ages.size < 2 * BLOCKS or not np.ptp(ages) > 0.0:
        return Estimate(float(ages.mean()), float(np.std(ages) / np.sqrt(ages.size)))
    means = [part.mean() for part in np.array_split(ages, BLOCKS)]
    return Estimate(float(ages.mean()), float(np.std(means, ddof=1) / np.sqrt(BLOCKS)))


def _scheduled(spec: Spec) -> Iterator[tuple[str, float]]:
    """Mean age at use on each link by the schedule of a spec, s."""
    schedule, whole = Schedule(spec), spec.hyperperiod_ns
    for name, link in schedule.links.items():
        source, receiver = clock_of(name, schedule)
        begin = -(-link.reach_ns // whole) * whole
        end = begin + SCHEDULED * whole
        if receiver:
            uses = schedule.ticks(receiver, begin, end) * receiver
            number = newest(link, source, uses)
            ages = (uses - number * source)[number >= 0]
        else:
            sent = schedule.commands(begin, end).time if name == "tau4" else None
            sent = schedule.ticks(source, begin, end) * source if sent is None else sent
            due = due_of(link, sent)
            ages = (due - sent)[due != NEVER]
        if ages.size:
            yield name, float(np.mean(ages)) / NS


def _motors(recording: Recording, spec: Spec) -> dict[str, Estimate]:
    """Effective delay of command to motion of every actuator whose motor moved."""
    td1, poles = spec.loop().timing.td1, spec.loop().actuator.motor_poles or ()
    slow, fast = sorted((1.0 / pole for pole in poles), reverse=True) if poles else (0.0, 0.0)
    found = {}
    for actuated in motions_of(synchronised(recording), spec):
        stretch = _liveliest(actuated)
        if stretch is not None:
            motor = fitted_motor(stretch, td1, (slow, fast))
            name = f"{actuated.actuator}.command to {actuated.actuator}.motor"
            found[name] = _effective(motor.value, motor.std, stretch.waited)
    return found


def _effective(value: Floats, std: Floats, waited: float | None) -> Estimate:
    """Delay of a slow motion through a motor: that of its begin, and both time constants.

    A motor does not move before its command is used: where the use is known, no part of the delay is below
    zero.
    """
    lag = float(value[DELAY] + value[SLOW] + value[FAST])
    return Estimate((max(lag, 0.0) + waited) if waited is not None else lag, float(std[DELAY]))


def _liveliest(actuated: Actuated) -> Actuated | None:
    """Stretch in which a motor was commanded to move most; None where nothing was, or it is not measured."""
    from dataclasses import replace

    known = np.isfinite(actuated.motor)
    if (
        known.sum() < FEWEST_OF_A_MOTOR
        or not actuated.command.size
        or not np.ptp(actuated.motor[known]) > 0.0
    ):
        return None
    rows = np.flatnonzero(known)
    parts = np.array_split(rows, -(-rows.size // FITTED))
    best = max(parts, key=lambda part: float(np.var(actuated.motor[part])))
    first = max(int(np.searchsorted(actuated.command_time, actuated.time[best[0]])) - FEWEST_OF_A_MOTOR, 0)
    last = int(np.searchsorted(actuated.command_time, actuated.time[best[-1]], side="right"))
    if last - first < 2:
        return None
    columns = ("time", "motor", "force", "position", "velocity")
    return replace(
        actuated,
        **{name: getattr(actuated, name)[best] for name in columns},
        command_time=actuated.command_time[first:last],
        command=actuated.command[first:last],
    )
