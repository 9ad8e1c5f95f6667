"""Delay and poles of a motor: ``u(t) = gain h(s) u_d(t - delay) + offset``, two time constants.

Commands are held, so what a motor should have done is known at any instant, as a sum of two exponentials
behind each command.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.optimize import least_squares

from rthm_analysis.identification.estimate import Fit, covariance

if TYPE_CHECKING:
    from rthm_analysis.identification.evidence import Motion
    from rthm_core.compiled import Floats

LONGEST, COARSE = 0.5, 2e-3
"""Longest delay that is looked for, and the distance of the delays that are tried, s."""
SHORTEST = 1e-7
"""Time constant that is none, s."""
SEEN = 2.0
"""Standard deviations that a time constant has to be away from zero, or from another one, to be told."""
UNSEEN_LAG = 0.1
"""Time constant that cannot be seen, over the period of the samples."""
DELAY, SLOW, FAST, GAIN, OFFSET = range(5)


class Motor(NamedTuple):
    """A fitted motor.

    Attributes
    ----------
    value, std : (5,) arrays
        Delay (s), slow and fast time constant (s), gain and offset (m), and their standard deviations.
    seen : (5,) array
        Which of them the recording shows; a time constant that it does not show has the believed value, or
        is none where that contradicts the recording.
    """

    value: Floats
    std: Floats
    seen: tuple[bool, ...]


def response(at: Floats, times: Floats, command: Floats, delay: float, slow: float, fast: float) -> Floats:
    """Motion (s,) of a motor of gain 1 at the instants `at` under commands that are held.

    Parameters
    ----------
    at, times : (s,), (c,) arrays
        Instants, and those at which commands (c,) are used, s, ascending.
    delay, slow, fast
        From use to the begin of the motion, and time constants, s.
    """
    if abs(slow - fast) <= 1e-4 * slow:
        fast = 0.9999 * slow - SHORTEST
    last = np.maximum(np.searchsorted(times + delay, at, side="right") - 1, 0)
    since = np.maximum(at - times[last] - delay, 0.0)
    moved = command[last]
    for own, other in ((slow, fast), (fast, slow)):
        if own > SHORTEST:
            moved = moved - own / (own - other) * _remains(times, command, own)[last] * np.exp(-since / own)
    return moved


def _remains(times: Floats, command: Floats, constant: float) -> Floats:
    """Sum (c,) of all steps up to each command, as far as they have not died away by then."""
    decay = np.exp(-np.diff(times, prepend=times[0]) / constant).tolist()
    steps = np.diff(command, prepend=command[0]).tolist()
    found, remains = [], 0.0
    for share, step in zip(decay, steps, strict=True):
        remains = remains * share + step
        found.append(remains)
    return np.array(found)


def fitted_motor(motion: Motion, period: float, believed: tuple[float, float]) -> Motor:
    """Fit a motor, with as many time constants as the samples show.

    Parameters
    ----------
    motion
        Its commands and its measured position, all of them known.
    period
        Of the samples, s.
    believed
        Slow and fast time constant of the spec, s; 0: none.
    """
    start = np.array([_first_delay(motion, period), period, 0.3 * period, 1.0, 0.0])
    slow, fast = (max(constant, SHORTEST) for constant in believed)
    ways = [{}, {FAST: fast}, {FAST: SHORTEST}, {SLOW: slow, FAST: fast}, {SLOW: SHORTEST, FAST: SHORTEST}]
    fits = [_fitted(motion, start, fixed) for fixed in ways]
    squares = [float(np.sum(np.square(fit.left))) for fit in fits]
    enough = min(squares) * (1.0 + SEEN**2 / motion.time.size)
    good = [i for i, square in enumerate(squares) if square <= enough]
    shown = [i for i in good if all(_is_shown(fits[i], k, period) for k in (SLOW, FAST) if k not in ways[i])]
    chosen = shown[0] if shown else good[-1]
    std, value = fits[chosen].std.copy(), fits[chosen].value
    others = [fits[i].value[DELAY] - value[DELAY] for i in good]  # as likely, and differ in what is kept
    std[DELAY] = np.hypot(std[DELAY], np.abs(others).max())
    if value[SLOW] < period:
        std[DELAY] = np.hypot(std[DELAY], _unresolved(motion, float(value[DELAY])) / np.sqrt(12.0))
    return Motor(value, std, tuple(k not in ways[chosen] for k in range(5)))


def _is_shown(fit: Fit, which: int, period: float) -> bool:
    return bool(fit.value[which] > max(SEEN * fit.std[which], UNSEEN_LAG * period))


def _moved(motion: Motion, p: Floats) -> Floats:
    shape = response(motion.time, motion.command_time, motion.command, *p[:GAIN])
    return np.asarray(p[GAIN] * shape + p[OFFSET])


def _first_delay(motion: Motion, period: float) -> float:
    """Delay (s) at which the motion of a quick motor is most like the measured one."""
    delays = np.arange(-0.01, LONGEST, COARSE)
    errors = [_error(motion, np.array([delay, period, SHORTEST, 1.0, 0.0])) for delay in delays]
    return float(delays[int(np.argmin(errors))])


def _fitted(motion: Motion, start: Floats, fixed: dict[int, float]) -> Fit:
    """Fit all numbers but those that are fixed, from where they start."""
    which = [i for i in range(start.size) if i not in fixed]
    known = start.copy()
    known[list(fixed)] = list(fixed.values())
    if known[SLOW] <= SHORTEST:  # then motions are steps, which have no slope to go along
        known[DELAY] = _nearest_delay(motion, known)

    def whole(p: Floats) -> Floats:
        all_of_it = known.copy()
        all_of_it[which] = p
        return all_of_it

    def left(p: Floats) -> Floats:
        return np.asarray(motion.motor - _moved(motion, whole(p)))

    lowest = np.array([-0.1, SHORTEST, SHORTEST, -np.inf, -np.inf])[which]
    highest = np.array([2.0 * LONGEST, LONGEST, LONGEST, np.inf, np.inf])[which]
    scale = np.array([1e-3, 1e-3, 1e-3, 1.0, max(float(np.ptp(motion.motor)), 1e-9)])[which]
    found = least_squares(left, known[which], bounds=(lowest, highest), x_scale=scale, xtol=1e-12)
    full, jac = np.zeros((5, 5)), np.asarray(found.jac)
    full[np.ix_(which, which)] = covariance(jac, jac, found.fun)
    fit = Fit(whole(found.x), full, found.fun)
    return fit if fixed else _slow_first(fit)


def _nearest_delay(motion: Motion, start: Floats) -> float:
    """Delay (s) with the least error around that of `start`; in the middle of equal ones."""
    reach = 4.0 * start[SLOW] + 4.0 * float(np.median(np.diff(motion.time)))
    delays = start[DELAY] + np.linspace(-reach, reach, 201)
    errors = [_error(motion, np.array([delay, *start[1:GAIN], 1.0, 0.0])) for delay in delays]
    best = np.flatnonzero(np.array(errors) <= min(errors) * (1.0 + 1e-9))
    return float(delays[best].mean())


def _slow_first(fit: Fit) -> Fit:
    if fit.value[SLOW] >= fit.value[FAST]:
        return fit
    order = [DELAY, FAST, SLOW, GAIN, OFFSET]
    return Fit(fit.value[order], fit.covariance[np.ix_(order, order)], fit.left)


def _unresolved(motion: Motion, delay: float) -> float:
    """Time (s) around the begin of a motion in which no command was followed by a sample."""
    at, times = motion.time - delay, motion.command_time
    after = np.searchsorted(times, at, side="right")
    within = (after > 0) & (after < times.size)
    since, until = at[within] - times[after[within] - 1], times[after[within]] - at[within]
    return float(since.min(initial=LONGEST) + until.min(initial=LONGEST))


def _error(motion: Motion, p: Floats) -> float:
    """Variance that a motion of this shape leaves, whatever its gain."""
    shape = _moved(motion, p)
    return float(np.var(motion.motor) * (1.0 - np.corrcoef(shape, motion.motor)[0, 1] ** 2))
