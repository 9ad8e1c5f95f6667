"""Known external forces w1 and w2 and their time derivatives.

A load is a sum of sinusoids under a linear ramp, or a table with straight lines between its rows. Both are
given to the exact step by their
derivatives at its start.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from rthm_core.clock import NS, to_ns
from rthm_core.compiled import Floats, Integers, called
from rthm_core.errors import InputError

HARMONIC_ORDERS = 10
"""Derivatives that a sinusoid is given by; with `LONGEST_PHASE` its error is below 1e-13 of its amplitude."""

LONGEST_PHASE = 0.3
"""Longest step, in radians of the fastest sinusoid."""


class Load(NamedTuple):
    """Force on one dof: ``constant + ramp(t) sum(amplitude sin(frequency t + phase))``, or a table (times in
    ns, forces in N).
    """

    constant: float
    amplitude: Floats
    frequency: Floats
    phase: Floats
    ramp: float
    table_time: Integers
    table_force: Floats

    @property
    def orders(self) -> int:
        """How many derivatives a step needs."""
        return HARMONIC_ORDERS if self.amplitude.size else 2 if self.table_time.size else 1

    @property
    def longest_step(self) -> float:
        """Longest step, in seconds, over which these derivatives are exact."""
        fastest = float(np.abs(self.frequency).max(initial=0.0))
        return LONGEST_PHASE / fastest if fastest > 0.0 else np.inf

    @property
    def breakpoints(self) -> Integers:
        """Instants (ns) at which the load has a kink; no step may cross one."""
        ramp_end = [to_ns(self.ramp)] if self.ramp > 0.0 and self.amplitude.size else []
        return np.array(sorted([*ramp_end, *self.table_time]), dtype=np.int64)

    def force(self, time: Floats) -> Floats:
        """Force, N, at some instants, s, in an array of any shape.

        Examples
        --------
        >>> sinusoid(1.0, 2.0, np.pi, 0.0).force(np.array([0.0, 0.5]))
        array([1., 3.])
        """
        waves = zip(self.amplitude, self.frequency, self.phase, strict=True)
        force = sum((a * np.sin(w * time + p) for a, w, p in waves), np.zeros(time.shape))
        force *= np.minimum(time / self.ramp, 1.0) if self.ramp > 0.0 else 1.0
        if self.table_time.size:
            force += np.interp(time, self.table_time / NS, self.table_force)
        return np.asarray(force + self.constant)


NO_LOAD = Load(0.0, np.empty(0), np.empty(0), np.empty(0), 0.0, np.empty(0, dtype=np.int64), np.empty(0))


def sinusoid(constant: float, amplitude: float, frequency: float, phase: float) -> Load:
    """Force that swings about a constant (N, rad/s)."""
    if not amplitude:
        return NO_LOAD._replace(constant=constant)
    one, w, p = (np.array([value], dtype=float) for value in (amplitude, frequency, phase))
    return NO_LOAD._replace(constant=constant, amplitude=one, frequency=w, phase=p)


def load(section: Any) -> Load:
    """Load of a spec section ``load.plant`` or ``load.numerical``."""
    if section is None or section.kind == "none":
        return NO_LOAD
    if section.kind == "constant":
        return NO_LOAD._replace(constant=float(section.force))
    if section.kind == "harmonic":
        return sinusoid(0.0, section.amplitude, section.frequency, section.phase)
    if section.kind == "multisine":
        return _multisine(section)
    return _from_file(section.path)


def _multisine(section: Any) -> Load:
    """Sum of `count` sinusoids of equal amplitude, evenly spaced from low to high, with random phases."""
    count = int(section.count)
    phases = np.random.default_rng(int(section.seed)).uniform(0.0, 2.0 * np.pi, count)
    return NO_LOAD._replace(
        amplitude=np.full(count, section.rms * np.sqrt(2.0 / count)),
        frequency=np.linspace(section.low, section.high, count),
        phase=phases,
        ramp=float(section.ramp),
    )


def _from_file(path: str) -> Load:
    try:
        rows = np.genfromtxt(Path(path).expanduser(), delimiter=",", names=True, dtype=float)
        time, force = np.atleast_1d(rows["t"]), np.atleast_1d(rows["force"])
    except (OSError, ValueError, IndexError, TypeError) as error:
        raise InputError(
            f"load file {path!r} could not be read as a CSV with the columns t (s) and force "
            f"(N): {str(error).splitlines()[0]}."
        ) from None
    if (
        time.size < 2
        or not np.all(np.isfinite(time))
        or not np.all(np.isfinite(force))
        or np.any(np.diff(time) <= 0.0)
    ):
        raise InputError(
            f"load file {path!r} needs at least two rows of finite numbers with ascending t; "
            f"sort and clean it."
        )
    return NO_LOAD._replace(table_time=np.rint(time * 1e9).astype(np.int64), table_force=force)


class Loads(NamedTuple):
    """Several loads, laid out for compiled code.

    Rows of `sines` are amplitude, frequency, phase and ramp; `which` says to which load a row belongs,
    `table_begin` where the table of a load begins.
    """

    constant: Floats
    which: Integers
    sines: Floats
    table_begin: Integers
    table_time: Integers
    table_force: Floats
    breakpoints: Integers
    orders: int
    longest_step: float


def together(loads: list[Load]) -> Loads:
    """Lay several loads out for compiled code."""
    sines = [np.full(one.amplitude.size, i) for i, one in enumerate(loads)]
    ramps = [np.full(one.amplitude.size, one.ramp) for one in loads]
    columns = [
        [one.amplitude for one in loads],
        [one.frequency for one in loads],
        [one.phase for one in loads],
        ramps,
    ]
    begins = np.concatenate([[0], np.cumsum([one.table_time.size for one in loads])])

    def joined(parts: list[Any], kind: type) -> Any:
        return np.concatenate(parts).astype(kind) if parts else np.empty(0, dtype=kind)

    return Loads(
        np.array([one.constant for one in loads], dtype=float),
        joined(sines, np.int64),
        np.ascontiguousarray(np.stack([joined(parts, float) for parts in columns], axis=1)),
        begins.astype(np.int64),
        joined([one.table_time for one in loads], np.int64),
        joined([one.table_force for one in loads], float),
        np.unique(joined([one.breakpoints for one in loads], np.int64)),
        max([one.orders for one in loads], default=1),
        min([one.longest_step for one in loads], default=float("inf")),
    )


@called
def load_derivatives(loads, t_ns, first, out):  # type: ignore[no-untyped-def]
    """Derivatives of all loads at `t_ns` (since the start of the test).

    ``out[k, first + i]`` gets derivative k of load i; `out` (orders, ...) may hold other inputs in other
    columns.
    """
    for i in range(loads.constant.size):
        out[0, first + i] = loads.constant[i]
        for k in range(1, out.shape[0]):
            out[k, first + i] = 0.0
        if loads.table_begin[i] < loads.table_begin[i + 1]:
            _table_derivatives(loads, i, t_ns, first + i, out)
    t = t_ns * 1e-9
    for s in range(loads.which.size):
        _sine_derivatives(loads.sines, s, t, first + loads.which[s], out)


@called
def _sine_derivatives(sines, s, t, column, out):  # type: ignore[no-untyped-def]
    size, frequency, ramp = sines[s, 0], sines[s, 1], sines[s, 3]
    angle = frequency * t + sines[s, 2]
    sine, cosine = math.sin(angle), math.cos(angle)
    ramped = ramp > 0.0 and t < ramp
    previous = 0.0
    for k in range(out.shape[0]):
        value = size * (sine if k % 4 == 0 else cosine if k % 4 == 1 else -sine if k % 4 == 2 else -cosine)
        out[k, column] += (value * t + k * previous) / ramp if ramped else value
        previous = value
        size *= frequency


@called
def first_after(instants, begin, end, t):  # type: ignore[no-untyped-def]
    """Index in [begin, end) of the first of the ascending `instants` that is later than `t`; `end` when there
    is none.
    """
    while begin < end:
        middle = (begin + end) // 2
        if instants[middle] > t:
            end = middle
        else:
            begin = middle + 1
    return begin


@called
def _table_derivatives(loads, i, t_ns, column, out):  # type: ignore[no-untyped-def]
    """Straight lines between the rows; the first and last value before and after the table."""
    begin, end = loads.table_begin[i], loads.table_begin[i + 1]
    time, force = loads.table_time, loads.table_force
    row = first_after(time, begin, end, t_ns) - 1
    if row < begin or row == end - 1:
        out[0, column] += force[max(row, begin)]
        return
    slope = (force[row + 1] - force[row]) / ((time[row + 1] - time[row]) * 1e-9)
    out[0, column] += force[row] + slope * ((t_ns - time[row]) * 1e-9)
    out[1, column] += slope


@called
def smooth_until(loads, now, to_ns):  # type: ignore[no-untyped-def]
    """Latest instant, at most `to_ns`, up to which the derivatives at `now` give the loads exactly."""
    end = to_ns
    if loads.longest_step < (end - now) * 1e-9:
        end = now + np.int64(loads.longest_step * 1e9)
    if loads.breakpoints.size:
        i = first_after(loads.breakpoints, 0, loads.breakpoints.size, now)
        if i < loads.breakpoints.size:
            end = min(end, loads.breakpoints[i])
    return end
