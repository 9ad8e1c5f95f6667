"""One hyperperiod of a settled loop as a list of what happens, with a place for every sample under way.

The cut is the instant just before all clocks tick together. What the loop has to remember there, beside the
motion, is every sample that was taken earlier and is used later::

        cut                                   cut + hyperperiod
    ----|----x-------x-----|----x----|--------|----
     ^ taken before,       ^ used after        ^ the same samples, one hyperperiod on

Samples, references and commands get numbered places; places 0, 1, ... are those remembered at the cut, and
`kept` says which places they are filled from at the next one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from rthm_core.compiled import Integers
from rthm_core.errors import InputError
from rthm_core.schedule import COMMAND, MOTOR, REFERENCE, SAMPLE, Events, Schedule

POSITION, VELOCITY, FORCE, SENT = range(4)
"""What is remembered: sampled positions, sampled velocities, force references, commands."""

NOWHERE = -1

MOST_REMEMBERED = 3000
"""Largest number of places at the cut; a matrix of the loop has about m times as many rows."""


class TooManySamplesError(InputError):
    """More samples are under way in a loop than can be followed."""


@dataclass(frozen=True)
class Cycle:
    """What happens in one hyperperiod, in order; times are multiples of `unit` since the cut.

    Attributes
    ----------
    duration : int
        The hyperperiod.
    unit : float
        Unit of all times, s.
    time, what : (E,) arrays
        Instant, and SAMPLE, REFERENCE, COMMAND or MOTOR.
    place : (E, 3) array
        SAMPLE: to position, to velocity. REFERENCE: to force, from position, from velocity. COMMAND: to sent,
        from position, from force. MOTOR: from sent. -1: nobody needs it.
    places : int
        Number of places.
    kind : (K,) array
        What the K places remembered at the cut hold.
    kept : (K,) array
        Places from which they are filled at the next cut.
    motor_held : bool
        Whether the motors' input at the cut lasts beyond it.
    intervals, advance : pairs of (D,) and (E + 1,) arrays
        Different intervals between two events that move the physical (numerical) side, and which of them
        passes before each event and at the end; -1: none.
    past : (E, 3, H) array
        Places of the H latest positions, velocities and references that the controller has latched, at its
        COMMAND events; H = 0 where it does not look back.
    stamps : (E, 2, H) array
        Stamps of these samples and references.
    command_period : int
        Td3.
    """

    duration: int
    unit: float
    time: Integers
    what: Integers
    place: Integers
    places: int
    kind: Integers
    kept: Integers
    motor_held: bool
    intervals: tuple[Integers, Integers]
    advance: tuple[Integers, Integers]
    past: Integers
    stamps: Integers
    command_period: int

    @property
    def hyperperiod(self) -> float:
        """Time after which everything repeats, s."""
        return self.duration * self.unit

    def scaled(self, factor: float) -> Cycle:
        """The cycle with every period and delay multiplied by `factor`: the same pattern in another unit."""
        return replace(self, unit=self.unit * factor)


def hyperperiod(schedule: Schedule) -> int:
    """Least common multiple of the clocks' periods."""
    periods = [schedule.td1, schedule.td2, schedule.td3, schedule.td4]
    return int(np.lcm.reduce(np.array([p for p in periods if p > 0], dtype=object)))


def cycle(schedule: Schedule, unit: float = 1e-9, history: int = 0) -> Cycle:
    """Cycle of a schedule whose links neither jitter nor lose anything, for a controller that looks back on
    `history` samples.

    Raises
    ------
    InputError
        When so much is under way at once that the loop's matrix would not fit.
    """
    duration = hyperperiod(schedule)
    reach = sum(link.delay_ns for link in schedule.links.values()) + schedule.motor_delay
    longest = max(schedule.td1, schedule.td2, schedule.td3, schedule.td4)
    span = (2 * history + 4) * longest
    begin = (-(-(reach + span) // duration) + 1) * duration
    events = _since_cut(schedule, schedule.events(begin, begin + duration), begin)
    latched = _latched(schedule, events, begin, span, history)
    periods = (schedule.td1, schedule.td1, schedule.td2, 1)
    memory = _Memory(events, latched, [duration // period for period in periods])
    physical = _intervals(events.time, (events.what == SAMPLE) | (events.what == MOTOR), duration)
    numerical = _intervals(events.time, events.what == REFERENCE, duration)
    return Cycle(
        duration,
        unit,
        events.time,
        events.what,
        memory.places_of(events),
        memory.places,
        memory.kind,
        memory.kept,
        not bool(((events.what == MOTOR) & (events.time == 0)).any()),
        (physical[0], numerical[0]),
        (physical[1], numerical[1]),
        memory.past(latched),
        latched * np.array([schedule.td1, schedule.td2])[:, None],
        schedule.td3,
    )


def _since_cut(schedule: Schedule, events: Events, begin: int) -> Events:
    """Events with all instants and numbers counted from the cut."""
    what = events.what
    index = np.where(what == SAMPLE, events.index - begin // schedule.td1, events.index - begin)
    return Events(
        events.time - begin,
        what,
        np.where(what == REFERENCE, events.index - begin // schedule.td2, index),
        events.state - begin // schedule.td1,
        events.reference - begin // schedule.td2,
    )


def _latched(schedule: Schedule, events: Events, begin: int, span: int, history: int) -> Integers:
    """Numbers since the cut (E, 2, H) of the samples and references that the controller has latched last."""
    if history == 0:
        return np.zeros((events.what.size, 2, 0), dtype=np.int64)
    before = schedule.commands(begin - span, begin)
    rows, columns = events.what == COMMAND, []
    past = (before.state - begin // schedule.td1, before.reference - begin // schedule.td2)
    for now, earlier in zip((events.state, events.reference), past, strict=True):
        different = np.union1d(now[rows], earlier)
        at = np.searchsorted(different, now)[:, None] - np.arange(history)
        columns.append(np.where(rows[:, None], different[np.clip(at, 0, different.size - 1)], 0))
    return np.stack(columns, axis=1)


class _Memory:
    """Places of everything that is remembered: first what is remembered at the cut, then what is new.

    Samples and references are known by their numbers since the cut, commands by their instants.
    """

    def __init__(self, events: Events, latched: Integers, per_cycle: list[int]) -> None:
        what = events.what
        numerical, self.command = what == REFERENCE, what == COMMAND
        states, references = (latched[self.command, k].ravel() for k in range(2))
        used = (
            np.concatenate([events.state[numerical | self.command], states]),
            np.concatenate([events.state[numerical], states]),
            np.concatenate([events.reference[self.command], references]),
            events.index[what == MOTOR],
        )
        old = [_remembered(np.unique(keys), n) for keys, n in zip(used, per_cycle, strict=True)]
        new = [
            np.union1d(keys[keys >= 0], (before + n)[before + n >= 0])
            for keys, before, n in zip(used, old, per_cycle, strict=True)
        ]
        _check_size(sum(keys.size for keys in old))
        self.keys = [np.concatenate(pair) for pair in zip(old, new, strict=True)]
        self.numbers = _numbered(old, new)
        self.places = sum(keys.size for keys in self.keys)
        self.kind = np.repeat(np.arange(4), [keys.size for keys in old])
        self.kept = np.concatenate([self.place(k, old[k] + per_cycle[k]) for k in range(4)])

    def place(self, kind: int, keys: Integers) -> Integers:
        """Places of some keys; NOWHERE for those that nobody needs."""
        known = self.keys[kind]
        if known.size == 0:
            return np.full(keys.size, NOWHERE, dtype=np.int64)
        at = np.minimum(np.searchsorted(known, keys), known.size - 1)
        return np.where(known[at] == keys, self.numbers[kind][at], NOWHERE)

    def past(self, latched: Integers) -> Integers:
        """Places (E, 3, H) of what the controller has latched."""
        kinds = ((POSITION, latched[:, 0]), (VELOCITY, latched[:, 0]), (FORCE, latched[:, 1]))
        found = [self.place(kind, keys.ravel()).reshape(keys.shape) for kind, keys in kinds]
        return np.where(self.command[:, None, None], np.stack(found, axis=1), NOWHERE)

    def places_of(self, events: Events) -> Integers:
        """Places (E, 3) that every event fills or reads (see `Cycle`)."""
        place = np.full((events.what.size, 3), NOWHERE, dtype=np.int64)
        columns = {
            SAMPLE: ((POSITION, events.index), (VELOCITY, events.index)),
            REFERENCE: ((FORCE, events.index), (POSITION, events.state), (VELOCITY, events.state)),
            COMMAND: ((SENT, events.index), (POSITION, events.state), (FORCE, events.reference)),
            MOTOR: ((SENT, events.index),),
        }
        for what, reads in columns.items():
            rows = events.what == what
            for column, (kind, keys) in enumerate(reads):
                place[rows, column] = self.place(kind, keys[rows])
        return place


def _remembered(used: Integers, per_cycle: int) -> Integers:
    """Keys before the cut that are used in it or, some whole cycles earlier, in a later one."""
    old = used[used < 0]
    repeats = -(old // per_cycle)
    cycles = np.arange(repeats.sum()) - np.repeat(np.cumsum(repeats) - repeats, repeats)
    return np.unique(np.repeat(old, repeats) + cycles * per_cycle)


def _numbered(old: list[Integers], new: list[Integers]) -> list[Integers]:
    """Places for the old keys of all kinds, then for the new ones."""
    sizes = [keys.size for keys in (*old, *new)]
    ends = np.cumsum([0, *sizes])
    spans = [np.arange(begin, end) for begin, end in pairwise(ends)]
    return [np.concatenate([spans[k], spans[len(old) + k]]) for k in range(len(old))]


def _check_size(remembered: int) -> None:
    if remembered > MOST_REMEMBERED:
        raise TooManySamplesError(
            f"timing: {remembered} samples are in transit at once, but at most {MOST_REMEMBERED} can be "
            f"followed; shorten the delays or lengthen the periods."
        )


def _intervals(time: Integers, moves: Integers, duration: int) -> tuple[Integers, Integers]:
    """Different intervals between the events that move a side, and which of them passes before each event."""
    moves = np.append(moves, True)
    passed = np.diff(np.append(time, duration)[moves], prepend=0)
    different, which = np.unique(passed, return_inverse=True)
    advance = np.full(moves.size, NOWHERE, dtype=np.int64)
    advance[moves] = np.where(passed > 0, which, NOWHERE)
    return different, advance
