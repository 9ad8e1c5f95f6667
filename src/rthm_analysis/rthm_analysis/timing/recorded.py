"""The event order of a recorded test: which sample was really used when.

With it, the exact engine repeats a test along the delays that it had, host stalls included,
so that what still differs from the recording is not timing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.recording import Recording
from rthm_analysis.timing.links import clock_of, ticks_of
from rthm_core.clock import NS, to_ns
from rthm_core.compiled import Floats, Integers
from rthm_core.errors import InputError
from rthm_core.link import NEVER, Link
from rthm_core.schedule import INITIAL, Commands, Depth, Events, Schedule, newest
from rthm_core.topics import COMMAND, FORCE_REFERENCE, LINKS

if TYPE_CHECKING:
    from rthm_core.spec import Spec

MOST_OFF = 50
"""References by which the time of a use may be off."""

CLOCKS = ("td1", "td2", "td3", "td4")


class RecordedSchedule(Schedule):
    """Schedule of a loop as it was in a recording.

    Commands are those of the recording, with the samples that the links tell: a tick that the controller
    left out sent none. A tick whose use is not recorded uses what the spec's schedule has there, but nothing
    older than what was used before and nothing newer than what is used next. Stamps that are off their clock
    count as its nearest tick. What a safety monitor did is not in it.

    Parameters
    ----------
    spec : Spec
        Loop to be simulated, with the clocks of the recorded test. Its delays act only where the recording
        has none: those of its motors.
    recording : Recording
        With all four links.

    Attributes
    ----------
    end : int
        Last instant of the recorded test, ns: before the sample that would follow the last one.

    Raises
    ------
    InputError
        When a link is not recorded, or a clock is another one.
    """

    def __init__(self, spec: Spec, recording: Recording) -> None:
        super().__init__(spec)
        _check(spec, recording)
        self._recording = recording
        self.end = to_ns(recording.duration) + self.td1 - 1
        self._latched = self._held("tau2")
        self._sent = self._all_commands()
        self._due, self._arriving = self._all_arrivals()
        states = np.concatenate([self._sent.state, self._latched])
        self._taken = np.unique(states[states != INITIAL])

    @property
    def depth(self) -> Depth:
        """How far back a sample, a reference or a command lies that is used."""
        sent, ticks = self._sent, self._latched
        samples = np.concatenate(
            [sent.time // self.td1 - sent.state, np.arange(ticks.size) * self.td2 // self.td1 - ticks]
        )
        place = np.searchsorted(sent.time, self._due, side="right")
        commands = place - np.searchsorted(sent.time, self._arriving.time)
        references = sent.time // self.td2 - sent.reference
        return Depth(*(int(count.max(initial=0)) + 8 for count in (samples, references, commands)))

    def events(self, begin: int, end: int, output: int | None = None) -> Events:
        """Everything that happened in [begin, end), in order; see `Schedule.events`.

        Raises
        ------
        InputError
            When `end` is after the recording's.
        """
        if end > self.end + 1:
            raise InputError(
                f"duration {(end - 1) / NS:g} s is longer than the recorded test, which has "
                f"{self.end / NS:g} s; give no more than that."
            )
        return super().events(begin, end, output)

    def references(self, begin: int, end: int) -> tuple[Integers, Integers]:
        """Numbers of the numerical ticks in [begin, end), and of the state sample that each used."""
        numbers = self.ticks(self.td2, begin, min(end, self.end + 1))
        return numbers, self._latched[numbers]

    def commands(self, begin: int, end: int) -> Commands:
        """Commands that were sent in [begin, end)."""
        return self._sent.rows(slice(*np.searchsorted(self._sent.time, [begin, end])))

    def arrivals(self, begin: int, end: int) -> tuple[Integers, Commands]:
        """Instants in [begin, end) at which a command became the input of a motor, and these commands."""
        within = slice(*np.searchsorted(self._due, [begin, end]))
        return self._due[within], self._arriving.rows(within)

    def samples(self, begin: int, end: int) -> Integers:
        """Numbers of the samples taken in [begin, end) that anybody used."""
        within = slice(*np.searchsorted(self._taken * self.td1, [begin, end]))
        return self._taken[within]

    def _told(self, name: str) -> tuple[Integers, Integers]:
        """Instants of use, and stamps as the sender's clock had them, ns after the start."""
        uses, start = self._recording.links[name], self._recording.start_ns
        return uses.use_ns - start, uses.sample_ns - start - self._offset(name)

    def _offset(self, name: str) -> int:
        told = self._recording.spec
        return Link(told, name).offset_ns if told is not None and told.is_loop else 0

    def _held(self, name: str) -> Integers:
        """Number of the sample in use at each tick of the receiver of `name`."""
        source, period = clock_of(name, self)
        use, stamp = self._told(name)
        tick, number = ticks_of(use, period), _numbers(stamp, source)
        ticks = np.arange(self.end // period + 1, dtype=np.int64)
        known = (tick >= 0) & (tick < ticks.size)
        tick, number = tick[known], number[known]
        following = np.append(number, NEVER)[np.searchsorted(tick, ticks)]
        held = np.minimum(newest(self.links[name], source, ticks * period), following)
        held[: tick.min(initial=ticks.size)] = INITIAL
        held[tick] = number
        return np.maximum.accumulate(held)

    def _all_commands(self) -> Commands:
        sent = self._recording.tables[COMMAND].stamp_ns - self._recording.start_ns
        time = np.unique(np.concatenate([sent, self._told("tau4")[1]]))
        time = time[(time >= 0) & (time <= self.end)]
        state = self._held("tau1")[time // self.td3]
        return Commands(time, state, self._references_of(time, sent), self._ranks(time % self.td3 == 0))

    def _references_of(self, time: Integers, sent: Integers) -> Integers:
        """Number of the reference in each of the commands at `time`.

        When the controller took a reference over is known as well as its host is punctual. A command tells
        the force that it used, so its reference is the nearest one with this force.
        """
        use, stamp = self._told("tau3")
        latest = np.searchsorted(use, time, side="right") - 1
        number = np.concatenate([[INITIAL], _numbers(stamp, self.td2)])[latest + 1]
        table = self._recording.tables.get(FORCE_REFERENCE)
        if table is None:
            return number
        begin = self._recording.start_ns + self._offset("tau3")
        made = _by_number(_numbers(table.stamp_ns - begin, self.td2), table.effort)
        told = self._recording.tables[COMMAND].columns("effort", table.names)
        at, there = np.searchsorted(time, sent), np.isin(sent, time)
        return _of_force(number, made, _by_number(at[there], told[there]))

    def _all_arrivals(self) -> tuple[Integers, Commands]:
        use, stamp = self._told("tau4")
        row = np.searchsorted(self._sent.time, stamp)
        there = (row < self._sent.time.size) & (stamp >= 0)
        order = np.argsort(use[there], kind="stable")
        due = use[there][order] + self.motor_delay
        return due, self._sent.rows(row[there][order])


def _numbers(stamps: Integers, period: int) -> Integers:
    """Number of the tick nearest to each of `stamps`."""
    return np.asarray((stamps + period // 2) // period, dtype=np.int64)


def _by_number(number: Integers, values: Floats) -> Floats:
    """Rows of `values` in the order of their numbers; NaN: none has the number."""
    kept = number >= 0
    rows = np.full((int(number.max(initial=-1)) + 1, values.shape[1]), np.nan)
    rows[number[kept]] = values[kept]
    return rows


def _of_force(number: Integers, made: Floats, told: Floats) -> Integers:
    """The numbers, each moved to the nearest reference of the force that its command tells."""
    found, searched = number.copy(), np.flatnonzero(np.isfinite(told).all(axis=1))
    for shift in sorted(range(-MOST_OFF, MOST_OFF + 1), key=abs):
        asked = number[searched] + shift
        there = (asked >= 0) & (asked < len(made))
        same = there.copy()
        same[there] = (made[asked[there]] == told[searched[there]]).all(axis=1)
        found[searched[same]] = asked[same]
        searched = searched[~same]
    return found


def _check(spec: Spec, recording: Recording) -> None:
    there = {*recording.links, *recording.tables}
    missing = [name for name in (*LINKS, COMMAND) if name not in there]
    if missing:
        raise InputError(
            f"the recording has no {', '.join(missing)}, so when its samples were used is not known; it "
            f"needs links/tau1 to links/tau4 and actuator/command: record all topics."
        )
    told = recording.spec
    if told is None or told.timing is None:
        return
    timing = spec.loop().timing
    for name in CLOCKS:
        if timing.ns(name) != told.timing.ns(name):
            raise InputError(
                f"timing.{name} is {timing.ns(name) / NS:g} s, in the recorded test it was "
                f"{told.timing.ns(name) / NS:g} s; give a spec with the clocks of the recorded test."
            )
