"""Which parameter of the numerical substructure is not the one of the spec.

State and force reference are recorded at every tick without noise, and so is what came in. From each tick to
the next the state is predicted from the recorded one, so an error does not pile up; F_d follows from the
state at its own tick. Only the load between two ticks is not known: a cubic is laid through it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.computed.structure import LOAD_COEFFICIENTS, Structure
from rthm_analysis.diagnosis.criteria.computed import (
    MOVED_PARAMETER_SHARE,
    MOVED_PARAMETER_STDS,
    NUMERICAL_LEFT_SHARE,
    NUMERICAL_MOST_PARAMETERS,
)
from rthm_analysis.recording import rows_of
from rthm_core.clock import NS
from rthm_core.topics import FORCE_REFERENCE, NUMERICAL_STATE

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.computed.latched import Latched
    from rthm_analysis.recording import Recording
    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec import Spec


Name = tuple[str, int]


@dataclass(frozen=True)
class Ticks:
    """Ticks of the numerical substructure.

    Attributes
    ----------
    time : (n,) array
        ns after the start.
    z2 : (n, 2 k) array
        [x2, v2].
    force : (n, m) array
        F_d, N; NaN: not recorded.
    held : (n, 2 m) array
        [x1, v1] held from this tick on; NaN: not known.
    load : (n, LOAD_COEFFICIENTS, k) array
        w2 and its derivatives at this tick, N, N/s, ...
    period : int
        ns.
    """

    time: Integers
    z2: Floats
    force: Floats
    held: Floats
    load: Floats
    period: int

    @property
    def steps(self) -> Integers:
        """Rows from which the next tick is known and can be predicted."""
        follows = np.diff(self.time) == self.period
        state = np.asarray(np.isfinite(self.z2).all(axis=1))
        known = np.isfinite(self.held[:-1]).all(axis=1) & state[1:]
        return np.flatnonzero(follows & known & state[:-1])

    @property
    def told(self) -> Integers:
        """Rows whose force reference can be computed."""
        known = np.isfinite(self.force) & np.asarray(np.isfinite(self.held).all(axis=1))[:, None]
        return np.flatnonzero(known.all(axis=1) & np.isfinite(self.z2).all(axis=1))

    def part(self, begin_ns: int, end_ns: int) -> Ticks:
        """Return the ticks in a span of time."""
        rows = (self.time >= begin_ns) & (self.time < end_ns)
        return Ticks(
            self.time[rows], self.z2[rows], self.force[rows], self.held[rows], self.load[rows], self.period
        )


def ticks_of(recording: Recording, spec: Spec, held: Latched) -> Ticks:
    """Ticks of the numerical substructure as recorded."""
    loop = spec.loop()
    table = recording.tables[NUMERICAL_STATE]
    forces = recording.tables.get(FORCE_REFERENCE)
    time = table.stamp_ns - recording.start_ns
    number = np.rint(time / held.period).astype(np.int64)
    z2 = np.hstack([table.columns(field, loop.numerical.dofs) for field in ("position", "velocity")])
    load = np.nan_to_num(table.columns("effort", loop.numerical.dofs), nan=0.0)
    force = np.full((time.size, len(loop.actuator.names)), np.nan)
    if forces is not None:
        row, same = rows_of(forces.stamp_ns, table.stamp_ns)
        force[same] = forces.columns("effort", loop.actuator.names)[row[same]]
    return Ticks(time, z2, force, held.at(number), _derivatives(time, load), held.period)


def _derivatives(time: Integers, load: Floats) -> Floats:
    """Load and its derivatives (n, LOAD_COEFFICIENTS, k) of the cubic spline through its samples."""
    if time.size < 4 or not load.any():
        return np.stack([load, *(np.zeros_like(load) for _ in range(LOAD_COEFFICIENTS - 1))], axis=1)
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(time / NS, load)
    return np.stack([spline(time / NS, order) for order in range(LOAD_COEFFICIENTS)], axis=1)


def load_uncertainty(ticks: Ticks) -> float:
    """Rms of what is not known of the load between two ticks, N, from how well every other tick tells it."""
    load, time = ticks.load[:, 0], ticks.time / NS
    if time.size < 12 or not load.any():
        return 0.0
    from scipy.interpolate import CubicSpline

    missed = load[1:-1:2] - CubicSpline(time[::2], load[::2])(time[1:-1:2])
    return float(np.sqrt(np.mean(missed**2))) / 16.0


@dataclass(frozen=True)
class Scales:
    """Rms of the change of the state from tick to tick (2 k,), and of F_d (m,)."""

    change: Floats
    force: Floats


def scales(ticks: Ticks) -> Scales:
    """Sizes by which errors are judged."""
    steps, told = ticks.steps, ticks.told
    change = _rms(ticks.z2[steps + 1] - ticks.z2[steps]) if steps.size else np.ones(ticks.z2.shape[1])
    force = _rms(ticks.force[told]) if told.size else np.ones(ticks.force.shape[1])
    return Scales(np.maximum(change, 1e-15), np.maximum(force, 1e-12))


def _rms(values: Floats) -> Floats:
    return np.asarray(np.sqrt(np.mean(np.square(values), axis=0)))


def errors(ticks: Ticks, one: Structure, sizes: Scales) -> Floats:
    """Recorded minus predicted change of state and F_d, each over its size, in one row."""
    steps, told = ticks.steps, ticks.told
    step = one.step(ticks.period / NS)
    next_z2 = ticks.z2[steps] @ step.state.T + ticks.held[steps] @ step.held.T
    next_z2 += np.einsum("nkj,kij->ni", ticks.load[steps], step.load)
    of_state = (ticks.z2[steps + 1] - next_z2) / sizes.change
    of_force = (ticks.force[told] - one.force(ticks.held[told], ticks.z2[told])) / sizes.force
    return np.concatenate([of_state.ravel(), of_force.ravel()])


def size_of(error: Floats) -> float:
    """Rms of errors."""
    return float(np.sqrt(np.mean(error**2))) if error.size else 0.0


def fitted(
    ticks: Ticks, start: Structure, names: tuple[Name, ...], sizes: Scales
) -> tuple[Structure, Floats]:
    """Most likely values of some parameters (Gauss and Newton), and their standard deviations."""
    one, std = start, np.full(len(names), np.inf)
    error = errors(ticks, one, sizes)
    for _ in range(8):
        slope = np.column_stack([_slope(ticks, one, name, sizes, error) for name in names])
        if not np.isfinite(slope).all():
            break
        change = np.asarray(np.linalg.lstsq(slope, error, rcond=None)[0], dtype=float)
        other = _moved(one, names, change)
        after = errors(ticks, other, sizes)
        if size_of(after) > size_of(error):
            break
        done = size_of(after) > 0.999 * size_of(error)
        one, error = other, after
        std = size_of(error) * np.sqrt(np.diag(np.linalg.pinv(slope.T @ slope)))
        if done:
            break
    values = np.array([abs(one.value(name)) for name in names])
    return one, np.maximum(std, 1e-9 * values)


def _slope(ticks: Ticks, one: Structure, name: Name, sizes: Scales, error: Floats) -> Floats:
    """How the errors fall with a parameter."""
    reach = 1e-5 * max(abs(one.value(name)), 1e-3)
    return (error - errors(ticks, one.changed(name, one.value(name) + reach), sizes)) / reach


def _moved(one: Structure, names: tuple[Name, ...], change: Floats) -> Structure:
    """Structure with changed parameters; none more than halves or grows by more than ten times at once."""
    for name, more in zip(names, change.tolist(), strict=True):
        value = one.value(name)
        low, high = sorted((0.5 * value, 10.0 * value)) if value else (-np.inf, np.inf)
        one = one.changed(name, float(np.clip(value + more, low, high)))
    return one


@dataclass(frozen=True)
class Search:
    """What a search for wrong parameters found.

    Attributes
    ----------
    names : tuple
        Parameters that are wrong; none: nothing is, or nothing that a parameter explains.
    structure : Structure
        With their values.
    std : array
        Their standard deviations.
    nominal, left : float
        Error on the judging ticks with the spec's values and with these.
    tried : dict
        Error on the judging ticks with each single parameter fitted.
    """

    names: tuple[Name, ...]
    structure: Structure
    std: Floats
    nominal: float
    left: float
    tried: dict[Name, float]


def search(train: Ticks, judge: Ticks, nominal: Structure, sizes: Scales, enough: float) -> Search:
    """Find the fewest parameters, fitted to `train`, that bring the error on `judge` down.

    Parameters
    ----------
    sizes : Scales
        Of both: a test may begin with a rest.
    enough : float
        Error that needs no explanation.
    """
    first = size_of(errors(judge, nominal, sizes))
    nothing = Search((), nominal, np.empty(0), first, first, {})
    if first <= enough:
        return nothing
    tried: dict[Name, Search] = {}
    for name in nominal.names:
        tried[name] = _explained_by((name,), train, judge, nominal, sizes, first)
    best = min(tried.values(), key=lambda one: one.left)
    if best.left > enough:
        several = _explained_by(_moving(train, nominal, sizes), train, judge, nominal, sizes, first)
        best = several if several.names and several.left < NUMERICAL_LEFT_SHARE * best.left else best
    if best.left > NUMERICAL_LEFT_SHARE * first:
        return nothing
    return replace(best, tried={name: one.left for name, one in tried.items()})


def _explained_by(
    names: tuple[Name, ...], train: Ticks, judge: Ticks, nominal: Structure, sizes: Scales, first: float
) -> Search:
    one, std = fitted(train, nominal, names, sizes) if names else (nominal, np.empty(0))
    return Search(names, one, std, first, size_of(errors(judge, one, sizes)), {})


def _moving(train: Ticks, nominal: Structure, sizes: Scales) -> tuple[Name, ...]:
    """Parameters that move when all are fitted at once; none when they are too many."""
    names = tuple(nominal.names)
    one, std = fitted(train, nominal, names, sizes)
    moved = [
        name
        for name, spread in zip(names, std, strict=True)
        if abs(one.value(name) - nominal.value(name))
        > max(MOVED_PARAMETER_STDS * spread, MOVED_PARAMETER_SHARE * abs(nominal.value(name)))
    ]
    return tuple(moved) if len(moved) <= NUMERICAL_MOST_PARAMETERS else ()


def replay(ticks: Ticks, one: Structure) -> Floats:
    """F_d (n, m) of a free run, started from the recorded state and, after a gap, started anew; N."""
    step = one.step(ticks.period / NS)
    driven = np.nan_to_num(ticks.held) @ step.held.T + np.einsum("nkj,kij->ni", ticks.load, step.load)
    state, goes_on = ticks.z2.copy(), np.zeros(ticks.time.size, dtype=bool)
    goes_on[ticks.steps + 1] = True
    matrix = step.state.T
    for row in np.flatnonzero(goes_on):
        state[row] = state[row - 1] @ matrix + driven[row - 1]
    return one.force(ticks.held, state)
