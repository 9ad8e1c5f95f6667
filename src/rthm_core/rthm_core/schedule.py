"""The event order of the loop as data.

Nothing in the loop's timing depends on its motion: which sample is used when follows from clocks, delays,
jitter and loss alone. A schedule
is therefore computed beforehand, and one table says what happens when, with which sample. The exact engine
executes it, the theory multiplies along
it, a recording is compared with it.

At one instant (contract, section 1): delays that are over, the motor's command first; sampling; the numerical
substructure; the controller; and
after each of the last three a delay of zero passes at once.
"""

from __future__ import annotations

import math
from copy import copy
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.clock import to_ns
from rthm_core.compiled import Flags, Integers
from rthm_core.link import NEVER, Link
from rthm_core.spec.effect import sizes
from rthm_core.topics import LINKS

if TYPE_CHECKING:
    from rthm_core.spec import Spec

SAMPLE, REFERENCE, COMMAND, MOTOR, OUTPUT = range(5)
"""What can happen: the plant is sampled, the numerical substructure ticks, the controller commands, a command
reaches the motor, a row is written."""

_MOTOR_DUE, _REFERENCE_DUE, _SAMPLING, _NUMERICAL, _CONTROL, _AFTER = 0, 2, 4, 5, 7, 9
_AT_ONCE = 1
_WHAT = np.arange(OUTPUT + 1)
_RANK = np.array([_SAMPLING, _NUMERICAL, _CONTROL, _MOTOR_DUE, _AFTER])
INITIAL = -1
"""Index of the sample in steady state before the test."""


class Commands(NamedTuple):
    """Commands of a span of time: when, with which state sample and which reference, and at which place in
    the order of their instant.
    """

    time: Integers
    state: Integers
    reference: Integers
    rank: Integers

    def rows(self, which: Integers | slice) -> Commands:
        """Return some of the commands."""
        return Commands(*(column[which] for column in self))


class Depth(NamedTuple):
    """How many of the latest samples, references and commands can still be used."""

    samples: int
    references: int
    commands: int


class Events(NamedTuple):
    """What happens in a span of time, in order.

    `index` is the number of the sample, reference, command or output row; `state` and `reference` are the
    numbers of what it uses.
    """

    time: Integers
    what: Integers
    index: Integers  # type: ignore[assignment]
    state: Integers
    reference: Integers


class Streams(NamedTuple):
    """What happens in a span of time, each kind of event by itself, in order.

    Attributes
    ----------
    commands : Commands
        From the first that can arrive within the span to the last that can use a sample taken in it.
    ticks : array
        Numbers of the state samples that the ticks of the numerical side use, from the first of the span to
        the last that can use a sample taken in it.
    due : (A,) array
        Instants at which a command becomes the input of a motor.
    which : (A,) array
        Which of the commands.
    late : (A,) array
        Whether it does so at once, after what else happens at its instant.
    """

    commands: Commands
    ticks: Integers
    due: Integers
    which: Integers
    late: Flags


def newest(link: Link, period: int, uses: Integers) -> Integers:
    """Number of the newest sample of a clock of `period` that has passed `link` at each of the instants
    `uses` (ascending); -1: none yet.
    """
    if uses.size == 0:
        return np.empty(0, dtype=np.int64)
    if link.constant:
        return np.maximum((uses - link.delay_ns) // period, INITIAL)
    margin = link.reach_ns + (200 * period if link.loss > 0.0 else period)
    numbers = np.arange(max(0, int(uses[0] - margin) // period), int(uses[-1]) // period + 1, dtype=np.int64)
    return newest_arrived(numbers, link.due_all(numbers * period), uses)


def newest_arrived(numbers: Integers, due: Integers, uses: Integers) -> Integers:
    """Largest of `numbers` whose `due` time is over at each of the instants `uses`; -1: none."""
    order = np.argsort(due, kind="stable")
    latest = np.maximum.accumulate(numbers[order]) if numbers.size else numbers
    arrived = np.searchsorted(due[order], uses, side="right")
    return np.where(arrived > 0, latest[np.maximum(arrived - 1, 0)] if numbers.size else INITIAL, INITIAL)


def overtaking(due: Integers) -> Integers:
    """Positions, in the order of their due times, of the samples that a receiver ever uses: those that no
    newer sample has overtaken.
    """
    order = np.argsort(due, kind="stable")
    order = order[due[order] < NEVER]
    if order.size == 0:
        return order
    return order[order >= np.maximum.accumulate(order)]


class Schedule:
    """Schedule of a loop.

    Raises
    ------
    InputError
        When the spec describes no loop.
    """

    def __init__(self, spec: Spec) -> None:
        timing = spec.loop().timing
        self.td1, self.td2, self.td3, self.td4 = (timing.ns(name) for name in ("td1", "td2", "td3", "td4"))
        self.links = {name: Link(spec, name) for name in LINKS}
        # A clock_offset can leave less of tau4 than a motor faster than it takes off.
        self.motor_delay = max(
            to_ns(sum(sizes(spec.effects, "motor", "delay"))), -self.links["tau4"].delay_ns
        )
        self._forget()

    def _forget(self) -> None:
        """Keep no commands for a next question about them."""
        none = np.empty(0, dtype=np.int64)
        self._within_span, self._span = Commands(none, none, none, none), (0, 0)

    def copied(self) -> Schedule:
        """The same schedule, whose clocks and delays may be changed."""
        other = copy(self)
        other.links = {name: copy(link) for name, link in self.links.items()}
        other._forget()
        return other

    def delay_step(self, name: str) -> int:
        """Step of the delays of a link that make a difference, ns: those between two multiples of it, and the
        larger of the two, have the same schedule.

        A receiver that looks at the ticks of its clock has a newer sample, or has it not.
        """
        clocks = {"tau1": (self.td1, self.td3), "tau2": (self.td1, self.td2), "tau3": (self.td2, self.td4)}
        periods = clocks.get(name, (1,))
        return math.gcd(*periods) if all(periods) else 1

    @property
    def depth(self) -> Depth:
        """How far back a sample, a reference or a command can lie that is used now."""
        links, slowest = self.links, max(self.td2, self.td3)
        lost = 220 if any(link.loss for link in links.values()) else 0
        sampled = max(links["tau1"].reach_ns, links["tau2"].reach_ns) + 2 * slowest
        referred = links["tau3"].reach_ns + max(self.td4, self.td3)
        commanded = 2 * (links["tau4"].reach_ns + self.motor_delay)
        fastest = min(self.td2, self.td3, self.td4 or self.td3)
        return Depth(
            sampled // self.td1 + 8 + lost,
            referred // self.td2 + 8 + lost,
            commanded // fastest + 16 + 2 * lost,
        )

    def ticks(self, period: int, begin: int, end: int) -> Integers:
        """Numbers of the ticks of a clock in [begin, end)."""
        return np.arange(-(-max(begin, 0) // period), -(-max(end, 0) // period), dtype=np.int64)

    def references(self, begin: int, end: int) -> tuple[Integers, Integers]:
        """Numbers of the numerical ticks in [begin, end), and of the state sample that each uses."""
        numbers = self.ticks(self.td2, begin, end)
        return numbers, newest(self.links["tau2"], self.td1, numbers * self.td2)

    def commands(self, begin: int, end: int) -> Commands:
        """Commands in [begin, end): on every tick of the controller, and when a reference changes between two
        of them.
        """
        if self._span[0] <= begin and end <= self._span[1]:
            return self._within_span.rows(slice(*np.searchsorted(self._within_span.time, [begin, end])))
        self._within_span, self._span = self._commands(begin, end), (begin, end)
        return self._within_span

    def _commands(self, begin: int, end: int) -> Commands:
        regular = self.ticks(self.td3, begin, end) * self.td3
        changes = self._reference_changes(begin, end)
        time = np.concatenate([regular, changes[changes % self.td3 != 0]])
        time.sort(kind="stable")
        latched = time // self.td4 * self.td4 if self.td4 else time
        ticks = time // self.td3 * self.td3
        return Commands(
            time,
            newest(self.links["tau1"], self.td1, ticks),
            newest(self.links["tau3"], self.td2, latched),
            self._ranks(time == ticks),
        )

    def _ranks(self, regular: Flags) -> Integers:
        """Place in its instant of each command: an extra one is sent when a reference is due."""
        late_in_instant = regular | (self.links["tau3"].delay_ns == 0) | (self.td4 > 0)
        return np.where(late_in_instant, _CONTROL, _REFERENCE_DUE)

    def _reference_changes(self, begin: int, end: int) -> Integers:
        """Instants in [begin, end) at which the controller takes a reference over."""
        if self.td4:
            return self.ticks(self.td4, begin, end) * self.td4
        link = self.links["tau3"]
        numbers = self.ticks(self.td2, begin - 2 * link.reach_ns - self.td2, end)
        due = link.due_all(numbers * self.td2)
        if not link.constant:
            due = due[overtaking(due)]
        due = due[slice(*np.searchsorted(due, [begin, end]))]
        first = np.ones(due.size, dtype=bool)
        first[1:] = due[1:] > due[:-1]
        return due[first]

    def arrivals(self, begin: int, end: int) -> tuple[Integers, Commands]:
        """Instants in [begin, end) at which a command becomes the input of a motor, and these commands."""
        sent = self.commands(self._earliest(begin), end)
        due, used = self._used_commands(sent.time, begin, end)
        return due, sent.rows(used)

    def _used_commands(self, sent: Integers, begin: int, end: int) -> tuple[Integers, Integers]:
        """Instants in [begin, end) at which commands that are `sent` become the input of a motor, and which
        do.
        """
        due = self.links["tau4"].due_all(sent)
        if self.motor_delay:
            due = np.where(due < NEVER, due + self.motor_delay, NEVER)
        used = overtaking(due)
        due = due[used]
        within = slice(*np.searchsorted(due, [begin, end]))
        return due[within], used[within]

    def streams(self, begin: int, end: int) -> Streams:
        """Everything that happens in [begin, end), each kind of event by itself."""
        commands = self.commands(self._earliest(begin), self._latest(end))
        sent = commands.time[: np.searchsorted(commands.time, end)]
        due, which = self._used_commands(sent, begin, end)
        late = due == sent[which]
        if late.any():
            late &= commands.rank[which] == _CONTROL
        return Streams(commands, self.references(begin, self._latest(end))[1], due, which, late)

    def events(self, begin: int, end: int, output: int | None = None) -> Events:
        """Everything that happens in [begin, end), in order; with `output`, a row is written every `output`
        ns.
        """
        self.commands(self._earliest(begin), self._latest(end))
        numbers, numerical_state = self.references(begin, end)
        commands = self.commands(begin, end)
        due, arriving = self.arrivals(begin, end)
        at_once = due == arriving.time
        used = self.samples(begin, end)
        rows = self.ticks(output, begin, end) if output else np.empty(0, dtype=np.int64)
        sizes = [used.size, numbers.size, commands.time.size, due.size, rows.size]
        what = _WHAT.repeat(sizes)
        rank = _RANK.repeat(sizes)
        rank[what == COMMAND] = commands.rank
        rank[what == MOTOR] = np.where(at_once, arriving.rank + _AT_ONCE, _MOTOR_DUE)
        columns = (
            (used * self.td1, numbers * self.td2, commands.time, due, rows * (output or 0)),
            (used, numbers, commands.time, arriving.time, rows),
            (used, numerical_state, commands.state, arriving.state, rows),
            (used, numbers, commands.reference, arriving.reference, rows),
        )
        time, *others = (np.concatenate(column) for column in columns)
        order = np.lexsort((rank, time))
        return Events(time[order], what[order], *(column[order] for column in others))

    def _earliest(self, begin: int) -> int:
        """Instant of the first command that can arrive at or after `begin`."""
        return begin - 2 * self.links["tau4"].reach_ns - self.motor_delay - self.td3

    def _latest(self, end: int) -> int:
        """Instant up to which samples taken before `end` can still be used."""
        links = (self.links["tau1"], self.links["tau2"])
        lost = 200 * self.td1 if any(link.loss for link in links) else 0
        return end + max(link.reach_ns for link in links) + 2 * max(self.td2, self.td3) + lost

    def samples(self, begin: int, end: int) -> Integers:
        """Numbers of the samples taken in [begin, end) that anybody uses later."""
        ahead = self._latest(end)
        first, stop = -(-begin // self.td1), -(-end // self.td1)
        taken = np.zeros(max(stop - first, 0), dtype=bool)
        for used in (self.commands(begin, ahead).state, self.references(begin, ahead)[1]):
            taken[used[(used >= first) & (used < stop)] - first] = True
        return np.flatnonzero(taken) + first
