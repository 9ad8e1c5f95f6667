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

import math
from dataclasses import dataclass, replace

import numpy as np

from rthm_core.compiled import Flags, Integers
from rthm_core.errors import InputError
from rthm_core.schedule import COMMAND, MOTOR, REFERENCE, SAMPLE, Events, Schedule

POSITION, VELOCITY, FORCE, SENT = range(4)
"""What is remembered: sampled positions, sampled velocities, force references, commands."""

KINDS_COUNT = 4

NOTHING, NOWHERE = -1, -1

KINDS = np.array(
    [
        [POSITION, VELOCITY, NOTHING],
        [FORCE, POSITION, VELOCITY],
        [SENT, POSITION, FORCE],
        [SENT, NOTHING, NOTHING],
    ]
)
"""What SAMPLE, REFERENCE, COMMAND and MOTOR fill or read."""

READ = np.array([[0, 0, 0], [0, 1, 1], [0, 1, 1], [1, 0, 0]], dtype=bool)
"""What of this they read."""

PAST, LATCHED_OF = np.array([POSITION, VELOCITY, FORCE]), [0, 0, 1]
"""What a controller that looks back reads, and whether that is of a sample or of a reference."""

SPAN = 1 << 59
"""More than any instant, ns, and any number of a sample."""

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
    periods = (schedule.td1, schedule.td2, schedule.td3, schedule.td4)
    return math.lcm(*(period for period in periods if period > 0))


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
    periods = np.array([schedule.td1, schedule.td1, schedule.td2, 1])
    memory = _Memory(events, latched, duration // periods)
    physical = _intervals(events.time, (events.what == SAMPLE) | (events.what == MOTOR), duration)
    numerical = _intervals(events.time, events.what == REFERENCE, duration)
    return Cycle(
        duration,
        unit,
        events.time,
        events.what,
        memory.used,
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
        different = _ascending(np.concatenate([now[rows], earlier]))
        at = np.searchsorted(different, now)[:, None] - np.arange(history)
        columns.append(np.where(rows[:, None], different[np.clip(at, 0, different.size - 1)], 0))
    return np.stack(columns, axis=1)


class _Memory:
    """Places of everything that is remembered: first what is remembered at the cut, then what is new.

    Samples and references are known by their numbers since the cut, commands by their instants: their keys.
    A place is the position of a key among all, which are ordered as `_codes` says.
    """

    def __init__(self, events: Events, latched: Integers, per_cycle: Integers) -> None:
        self.kinds, self.keys = KINDS[events.what], _keys(events)
        self.command = events.what == COMMAND
        read, past = READ[events.what], latched[self.command][:, LATCHED_OF]
        past_kinds = np.broadcast_to(PAST[:, None], past.shape)
        kinds = np.concatenate([self.kinds[read], past_kinds.ravel()])
        keys = np.concatenate([self.keys[read], past.ravel()])
        old = _remembered(kinds, keys, per_cycle)
        _check_size(old.size)
        self.kind, key = _decoded(old)
        next_time, is_new = key + per_cycle[self.kind], keys >= 0
        new = [_codes(kinds[is_new], keys[is_new]), _codes(self.kind, next_time)[next_time >= 0]]
        self.known = np.concatenate([old, _ascending(np.concatenate(new))])
        self.kept = self.places_of(self.kind, next_time)

    @property
    def places(self) -> int:
        """Number of places."""
        return int(self.known.size)

    @property
    def used(self) -> Integers:
        """Places (E, 3) that every event fills or reads (see `Cycle`)."""
        return self.places_of(self.kinds, self.keys)

    def places_of(self, kinds: Integers, keys: Integers) -> Integers:
        """Places of some keys; NOWHERE for those that nobody needs."""
        codes = _codes(kinds, keys)
        at = np.minimum(self.known.searchsorted(codes), self.known.size - 1)
        return np.where(self.known[at] == codes, at, NOWHERE)

    def past(self, latched: Integers) -> Integers:
        """Places (E, 3, H) of what the controller has latched."""
        if latched.size == 0:
            return np.zeros((latched.shape[0], PAST.size, 0), dtype=np.int64)
        found = self.places_of(PAST[:, None], latched[:, LATCHED_OF])
        return np.where(self.command[:, None, None], found, NOWHERE)


def _keys(events: Events) -> Integers:
    """Keys (E, 3) of what every event fills or reads, of the `KINDS` of its row."""
    second = np.where(events.what == SAMPLE, events.index, events.state)
    third = np.where(events.what == COMMAND, events.reference, events.state)
    return np.stack([events.index, second, third], axis=1)


def _codes(kinds: Integers, keys: Integers) -> Integers:
    """One number for a key of a kind: keys before the cut come first, and among those, kind after kind."""
    return ((keys >= 0) * KINDS_COUNT + kinds) * SPAN + (keys + SPAN // 2)


def _decoded(codes: Integers) -> tuple[Integers, Integers]:
    """Kinds and keys of codes of keys before the cut."""
    kinds = codes // SPAN
    return kinds, codes - kinds * SPAN - SPAN // 2


def _remembered(kinds: Integers, keys: Integers, per_cycle: Integers) -> Integers:
    """Codes of what lies before the cut and is used in this cycle or, some cycles on, in a later one."""
    is_old = keys < 0
    kinds, keys = kinds[is_old], keys[is_old]
    repeats = -(keys // per_cycle[kinds])
    cycles = np.arange(repeats.sum()) - (repeats.cumsum() - repeats).repeat(repeats)
    kinds = kinds.repeat(repeats)
    return _ascending(_codes(kinds, keys.repeat(repeats) + cycles * per_cycle[kinds]))


def _ascending(values: Integers) -> Integers:
    """Different values, the smallest first: as `numpy.unique`, in a third of the time for few of them."""
    found = np.sort(values)
    is_first = np.ones(found.size, dtype=bool)
    np.not_equal(found[1:], found[:-1], out=is_first[1:])
    return found[is_first]


def _check_size(remembered: int) -> None:
    if remembered > MOST_REMEMBERED:
        raise TooManySamplesError(
            f"timing: {remembered} samples are in transit at once, but at most {MOST_REMEMBERED} can be "
            f"followed; shorten the delays or lengthen the periods."
        )


def _intervals(time: Integers, moves: Flags, duration: int) -> tuple[Integers, Integers]:
    """Different intervals between the events that move a side, and which of them passes before each event."""
    at = np.append(moves.nonzero()[0], moves.size)
    instants = np.append(time, duration)[at]
    passed = instants.copy()
    passed[1:] -= instants[:-1]
    different = _ascending(passed)
    advance = np.full(moves.size + 1, NOWHERE, dtype=np.int64)
    advance[at] = np.where(passed > 0, different.searchsorted(passed), NOWHERE)
    return different, advance
