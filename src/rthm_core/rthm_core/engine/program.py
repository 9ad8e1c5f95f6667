"""The schedule reduced to a short list of operations for the linear kernel.

Between two commands the motion of the plant is known in closed form, so that only `MOTOR` and `REFERENCE`
move a state, and `SAMPLE` and `OUTPUT` look at it. A command is computed where it reaches the motor, from the
sample and the reference that it was given with.

Where clocks and delays repeat, one hyperperiod is the whole program: numbers of samples become distances back
from the newest, which are the same in every hyperperiod, and what lies before the test is the initial value.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rthm_core.compiled import Integers
from rthm_core.schedule import COMMAND, INITIAL, MOTOR, OUTPUT, REFERENCE, SAMPLE, Schedule

if TYPE_CHECKING:
    from rthm_core.spec import Spec

STEP = COMMAND
"""Operation that only lets time pass on the plant's side; it takes the code of the commands, which no program
has.
"""

LONGEST_PERIOD_OPERATIONS = 20_000
"""Longest hyperperiod, in operations, that is worth a program of its own."""

FEW_LENGTHS = 512
"""Up to so many different step lengths each has its own matrix."""


class Program(NamedTuple):
    """Operations in order; all arrays (operations,).

    Attributes
    ----------
    what : array
        `SAMPLE`, `REFERENCE`, `MOTOR`, `OUTPUT` or `STEP`.
    time : array
        Instants in ns.
    plant, numerical : array
        Time in ns since the last change of each side's input, where the operation needs it, else 0.
    sample, reference : array
        How many samples and references back from the newest the ones that are used lie.
    """

    what: Integers
    time: Integers
    plant: Integers
    numerical: Integers
    sample: Integers
    reference: Integers


def period_ns(spec: Spec, schedule: Schedule, output: int) -> int | None:
    """Hyperperiod of clocks and rows in ns; None where links are irregular or it is too long."""
    if not all(link.constant for link in schedule.links.values()):
        return None
    period = int(np.lcm.reduce(np.array([spec.hyperperiod_ns, output], dtype=object)))
    ticks = sum(period // clock for clock in (schedule.td1, schedule.td2, schedule.td3, output))
    return period if ticks <= LONGEST_PERIOD_OPERATIONS else None


def reach_ns(schedule: Schedule) -> int:
    """Longest time, in ns, between a sample and anything that still depends on it through the links alone."""
    links = schedule.links.values()
    clocks = 2 * (schedule.td1 + schedule.td2 + schedule.td3 + schedule.td4)
    lost = 200 * max(schedule.td1, schedule.td2, schedule.td3) if any(link.loss for link in links) else 0
    return 2 * sum(link.reach_ns for link in links) + schedule.motor_delay + clocks + lost


def program(schedule: Schedule, begin: int, end: int, output: int) -> Program:
    """Operations of [begin, end) with a row every `output` ns, all in ns since the start; without lengths."""
    events = schedule.events(begin, end, output)
    time, what, _, state, reference = (column[events.what != COMMAND] for column in events)
    samples = schedule.samples(begin - reach_ns(schedule), end)
    first = int(np.searchsorted(samples * schedule.td1, begin))
    stored = first + np.cumsum(what == SAMPLE) - (what == SAMPLE)
    ticks = -(-begin // schedule.td2) + np.cumsum(what == REFERENCE) - (what == REFERENCE)
    rows = what == OUTPUT
    reference[rows] = _reference_in_use(schedule, begin, end, time[rows])
    place = np.where(state == INITIAL, INITIAL, np.searchsorted(samples, state))
    none = np.zeros_like(time)
    return Program(
        what,
        time,
        none,
        none,
        np.where((what == MOTOR) | (what == REFERENCE), stored - place, 0),
        np.where((what == MOTOR) | rows, ticks - reference, 0),
    )


def without_unused_samples(operations: Program) -> Program:
    """A program that repeats, less the samples that nothing is computed from; places back from the newest
    count those that are left.
    """
    sampling = operations.what == SAMPLE
    count = int(np.count_nonzero(sampling))
    users = (operations.what == MOTOR) | (operations.what == REFERENCE)
    stored = np.cumsum(sampling) - sampling
    passes, which = np.divmod(stored[users] - operations.sample[users], max(count, 1))
    used = np.zeros(count, dtype=bool)
    used[which] = True
    kept = ~sampling
    kept[sampling] = used
    before, rank = np.cumsum(sampling & kept) - (sampling & kept), np.cumsum(used) - used
    back = np.zeros_like(operations.sample)
    back[users] = before[users] - passes * np.count_nonzero(used) - rank[which]
    return Program(*(column[kept] for column in operations._replace(sample=back)))


def with_lengths(operations: Program, since: tuple[int, int], *, jointly: bool) -> Program:
    """The program with its lengths, when the inputs of the plant's and of the numerical side last changed at
    `since` (ns); `jointly`, both sides move at every change of an input of either.
    """
    time, what = operations.time, operations.what
    if jointly:
        both = time - _latest(time, (what == MOTOR) | (what == REFERENCE), since[0])
        return operations._replace(plant=both, numerical=both)
    plant = time - _latest(time, what == MOTOR, since[0])
    numerical = time - _latest(time, what == REFERENCE, since[1])
    return operations._replace(
        plant=np.where(what == REFERENCE, 0, plant),
        numerical=np.where((what == REFERENCE) | (what == OUTPUT), numerical, 0),
    )


def last_changes(operations: Program, since: tuple[int, int], *, jointly: bool) -> tuple[int, int]:
    """Instants of the last change of each side's input at the end of a program that began with `since`."""
    moves, ticks = operations.what == MOTOR, operations.what == REFERENCE
    if jointly:
        moves = ticks = moves | ticks
    found = [
        int(operations.time[one].max(initial=begin)) for one, begin in zip((moves, ticks), since, strict=True)
    ]
    return found[0], found[1]


def _reference_in_use(schedule: Schedule, begin: int, end: int, times: Integers) -> Integers:
    """Number of the reference that the controller uses at each of `times`."""
    commands = schedule.commands(begin - schedule.td3, end)
    place = np.searchsorted(commands.time, times, side="right") - 1
    return np.where(place >= 0, commands.reference[place], INITIAL)


def _latest(time: Integers, changes: Any, since: int) -> Integers:
    """Instant of the last change before each operation."""
    latest = np.maximum.accumulate(np.where(changes, time, since))
    return np.concatenate([[since], latest[:-1]])[: time.size].astype(np.int64)
