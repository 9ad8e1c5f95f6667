"""The ledger of a test from its recorded samples, as they come or all at once.

Samples may be added in any order. `EnergyLedger.advance` then carries the balance on to the newest sample of
the plant up to an instant; whoever listens to a running test asks for one that lies so far back that nothing
older can still arrive. The balance depends on the samples alone, not on when they were added or counted.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_analysis.energy.kernel import COMMAND, SAMPLE, TERM_COUNT, TICK, Balance, Events, account, row_width
from rthm_analysis.energy.model import begins, estimated_power, first_parts, load_at, open_balance, state_at
from rthm_analysis.energy.motion import completed_velocity, motion_at, window
from rthm_analysis.energy.series import Series, Uses
from rthm_analysis.recording.table import rows_of
from rthm_analysis.recording.uses import tick_of_each
from rthm_core.clock import NS
from rthm_core.compiled import Floats, Integers
from rthm_core.link import NEVER
from rthm_core.schedule import Schedule, newest_arrived, overtaking
from rthm_core.spec import Spec
from rthm_core.substructure import as_built, interface

KEPT_NS = 2_000_000_000
"""How long samples are kept after they were counted, beyond what the links need."""


class Rows(NamedTuple):
    """Energy balance at the samples of the plant.

    Attributes
    ----------
    stamp_ns : (n,) array
        Stamps of the samples.
    work : (n, 6) array
        Work so far, in the order of ``rthm_core.energy.TERMS``, J.
    total : (n,) array
        E_total, J.
    estimate : (n,) array
        Power of the corrected (27), W; NaN for a plant alone.
    passed : (n,) array
        Integral of the squared velocity of the plant at the interface (of all its dofs without one), m^2/s.
    """

    stamp_ns: Integers
    work: Floats
    total: Floats
    estimate: Floats
    passed: Floats


class Opening(NamedTuple):
    """Where the balance begins: a sample, z2, and what the numerical side and the motors hold there."""

    sample: int
    z2: Floats
    held: Floats
    first_fx: Floats
    first_ff: Floats


NO_ROWS = Rows(np.empty(0, dtype=np.int64), np.empty((0, TERM_COUNT)), np.empty(0), np.empty(0), np.empty(0))


class EnergyLedger:
    """Energy balance of a test.

    Parameters
    ----------
    spec : Spec
        The loop, or a plant alone.
    start_ns : int
        Stamp of the start of the test.
    period : float
        Sampling period of the plant, s.

    Attributes
    ----------
    begin_ns : int or None
        Stamp of the first sample in the balance; after the start when what happened before is not known.
    """

    def __init__(self, spec: Spec, start_ns: int, period: float) -> None:
        self.spec, self.start_ns = spec, start_ns
        self.begin_ns: int | None = None
        self._n1, self._n2 = len(spec.plant.dofs), len(spec.numerical.dofs) if spec.numerical else 0
        self._m = len(spec.k_tot)
        self._plant, self._ticks = Series(3 * self._n1), Series(2 * self._n2)
        self._commands, self._uses = Series(2 * self._m), {"tau2": Uses(), "tau4": Uses()}
        self._schedule = Schedule(spec) if spec.is_loop else None
        self._believed = np.array(as_built(spec, "controller").k_tot) if spec.is_loop else np.empty(0)
        self._width = window(spec, period)
        self._balance: Balance | None = None
        self._done = start_ns - 1
        self._load: Floats | None = None
        self._passed: tuple[Floats, Floats, float] | None = None

    def add_plant(self, stamps_ns: Integers, position: Floats, velocity: Floats, load: Floats) -> None:
        """Add samples of the plant's dofs, (n, n1) each: m, m/s, known external load in N; NaN: not known."""
        known = np.isfinite(position).all(axis=1)
        self._plant.add(stamps_ns[known], np.hstack([position, velocity, load])[known])

    def add_numerical(self, stamps_ns: Integers, position: Floats, velocity: Floats) -> None:
        """Add states of the numerical substructure at its ticks, (n, n2) each."""
        self._add(self._ticks, stamps_ns, np.hstack([position, velocity]))

    def add_commands(self, stamps_ns: Integers, command: Floats, force: Floats) -> None:
        """Add commands u_d in m and the F_d that they used in N, (n, m) each."""
        self._add(self._commands, stamps_ns, np.hstack([command, force]))

    def add_uses(self, link: str, use_ns: Integers, sample_ns: Integers) -> None:
        """Add uses of the link ``tau2`` or ``tau4``."""
        self._uses[link].add(use_ns, sample_ns)

    def advance(self, until_ns: int | None = None) -> Rows:
        """Count up to the newest sample of the plant not after `until_ns`; by default, everything."""
        stamps, motion = self._plant.stamps, self._motion()
        chosen = np.flatnonzero((stamps > self._done) & (stamps <= self._limit(until_ns)))
        if self._balance is None and chosen.size:
            chosen = self._open(chosen, motion)
        if not chosen.size:
            return NO_ROWS
        assert self._balance is not None
        events = self._events(chosen, motion)
        written = np.zeros((chosen.size, row_width(self._balance)))
        account(self._balance, events, written)
        self._done = int(stamps[chosen[-1]])
        rows = self._rows(stamps[chosen], events, written)
        self._forget()
        return rows

    @staticmethod
    def _add(series: Series, stamps_ns: Integers, rows: Floats) -> None:
        known = np.isfinite(rows).all(axis=1)
        series.add(stamps_ns[known], rows[known])

    def _motion(self) -> Floats:
        """Measured [x1, v1] of all samples at hand, missing velocities estimated."""
        rows, n1 = self._plant.rows, self._n1
        velocity = completed_velocity(self._plant.stamps, rows[:, :n1], rows[:, n1 : 2 * n1], self._width)
        return np.hstack([rows[:, :n1], velocity])

    def _limit(self, until_ns: int | None) -> int:
        """Last instant that can be counted: an estimated velocity waits for the samples after it."""
        stamps, rows = self._plant.stamps, self._plant.rows
        if until_ns is None or not stamps.size:
            return NEVER
        complete = np.isfinite(rows[-self._width :, : 2 * self._n1]).all()
        newest = stamps.size - 1 - (0 if complete else self._width)
        return min(until_ns, int(stamps[newest])) if newest >= 0 else self._done

    def _open(self, chosen: Integers, motion: Floats) -> Integers:
        """Open the balance at the first of the `chosen` samples before which everything is known."""
        stamps = self._plant.stamps
        if self._schedule is None:
            opening: Opening | None = Opening(
                int(chosen[0]), np.empty(0), np.empty(0), np.empty(0), np.empty(0)
            )
        elif begins(self.spec, self.start_ns, self._ticks):
            opening = Opening(int(chosen[0]), *first_parts(self.spec))
        else:
            opening = self._joining(chosen, motion)
        if opening is None:
            return chosen[:0]
        self.begin_ns = int(stamps[opening.sample])
        self._done = self.begin_ns - 1
        begin = self.begin_ns - self.start_ns
        self._balance = open_balance(self.spec, begin, motion[opening.sample], *opening[1:])
        return chosen[chosen >= opening.sample]

    def _joining(self, chosen: Integers, motion: Floats) -> Opening | None:
        """Opening within a test: once a command has been used and the held motion is known."""
        stamps, (use, parts) = self._plant.stamps, self._used_commands()
        held = self._held(motion)
        known = np.flatnonzero(np.isfinite(held).all(axis=1))
        if not known.size or not use.size:
            return None
        earliest = max(int(self._ticks.stamps[known[0]]), int(use[0]))
        later = chosen[stamps[chosen] >= earliest]
        if not later.size:
            return None
        begin = int(stamps[later[0]])
        tick = known[np.searchsorted(self._ticks.stamps[known], begin, side="right") - 1]
        since, until = int(self._ticks.stamps[tick]) - self.start_ns, begin - self.start_ns
        z2 = state_at(self.spec, since, self._ticks.rows[tick], held[tick], until)
        given = parts[np.searchsorted(use, begin, side="right") - 1]
        return Opening(int(later[0]), z2, held[tick], given[: self._m], given[self._m :])

    def _events(self, chosen: Integers, motion: Floats) -> Events:
        """Everything that happened after the last counted sample, up to the last of the `chosen` ones."""
        stamps = self._plant.stamps[chosen]
        use, parts = self._used_commands()
        command = (use > self._done) & (use <= stamps[-1])
        tick = (self._ticks.stamps > self._done) & (self._ticks.stamps <= stamps[-1])
        held = self._held(motion)[tick]
        times = [use[command], self._ticks.stamps[tick], stamps]
        what = np.repeat([COMMAND, TICK, SAMPLE], [part.size for part in times])
        time = np.concatenate(times) - self.start_ns
        index = np.concatenate([np.arange(part.size) for part in times])
        order = np.lexsort((what, time))
        load = self._loads(chosen)
        return Events(
            time[order],
            what[order],
            index[order],
            parts[command],
            self._ticks.rows[tick],
            held,
            motion[chosen],
            load,
        )

    def _used_commands(self) -> tuple[Integers, Floats]:
        """Instants at which commands became the input of the motors, and both parts of these commands."""
        stamps, rows, m = self._commands.stamps, self._commands.rows, self._m
        force_part = rows[:, m:] / self._believed
        parts = np.hstack([rows[:, :m] - force_part, force_part])
        if self._schedule is None or not stamps.size:
            return np.empty(0, dtype=np.int64), parts
        pairs = self._uses["tau4"].pairs
        row, found = rows_of(stamps, pairs[:, 1])
        if found.any():
            use, row = pairs[found, 0], row[found]
        else:  # none recorded, or stamps of another clock
            due = self._schedule.links["tau4"].due_all(stamps - self.start_ns)
            row = overtaking(due)
            use = due[row] + self.start_ns
        return use + self._schedule.motor_delay, parts[row]

    def _held(self, motion: Floats) -> Floats:
        """Motion [x1, v1] that the numerical side latched at each of its ticks; NaN: none, or not known."""
        ticks, stamps = self._ticks.stamps, self._plant.stamps
        held = np.full((ticks.size, 2 * self._m), np.nan)
        if self._schedule is None or not ticks.size or not stamps.size:
            return held
        pairs = self._uses["tau2"].pairs
        if pairs.size:
            tick, used = tick_of_each(pairs[:, 0], ticks, self._schedule.td2), pairs[:, 1]
        else:
            due = self._schedule.links["tau2"].due_all(stamps - self.start_ns)
            row = newest_arrived(np.arange(stamps.size), due, ticks - self.start_ns)
            tick, used = np.flatnonzero(row >= 0), stamps[row[row >= 0]]
        within = tick >= 0
        plant = interface(self.spec).plant
        latched = motion_at(stamps, motion, used[within])
        held[tick[within]] = latched[:, [*plant, *(self._n1 + plant)]]
        return held

    def _loads(self, chosen: Integers) -> Floats:
        """Mean of the measured loads beyond the spec's over the time before each of the `chosen` samples."""
        times = self._plant.stamps[chosen] - self.start_ns
        beyond = np.nan_to_num(self._plant.rows[chosen, 2 * self._n1 :] - load_at(self.spec, times))
        before = beyond[:1] if self._load is None else self._load
        self._load = beyond[-1:]
        return 0.5 * (beyond + np.vstack([before, beyond[:-1]]))

    def _rows(self, stamps: Integers, events: Events, written: Floats) -> Rows:
        estimate = np.full(stamps.size, np.nan)
        if self._schedule is not None:
            first = TERM_COUNT + 1 + self._n1
            velocity = np.hstack([events.sample[:, self._n1 :], written[:, first : first + self._n2]])
            acceleration = np.hstack([written[:, TERM_COUNT + 1 : first], written[:, first + self._n2 :]])
            estimate = estimated_power(self.spec, velocity, acceleration)
        return Rows(
            stamps, written[:, :TERM_COUNT], written[:, TERM_COUNT], estimate, self._passed_by(stamps, events)
        )

    def _passed_by(self, stamps: Integers, events: Events) -> Floats:
        dofs = interface(self.spec).plant if self.spec.is_loop else np.arange(self._n1)
        square = (events.sample[:, self._n1 + np.unique(dofs)] ** 2).sum(axis=1)
        time = (stamps - self.start_ns) / NS
        before = (time[:1], square[:1], 0.0) if self._passed is None else self._passed
        mean = 0.5 * (square + np.append(before[1], square[:-1]))
        passed = before[2] + np.cumsum(mean * np.diff(np.append(before[0], time)))
        self._passed = (time[-1:], square[-1:], float(passed[-1]))
        return passed

    def _forget(self) -> None:
        """Drop what nothing refers to any more."""
        reach = KEPT_NS
        if self._schedule is not None:
            links, motor = self._schedule.links, self._schedule.motor_delay
            reach += 2 * (links["tau2"].reach_ns + links["tau4"].reach_ns + motor + self._schedule.td2)
        every: tuple[Series | Uses, ...] = (self._plant, self._ticks, self._commands, *self._uses.values())
        for series in every:
            series.forget(self._done - reach)
