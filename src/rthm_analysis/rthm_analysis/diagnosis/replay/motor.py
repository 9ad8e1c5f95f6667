"""Motor positions on a time grid, from the commands as they fell due."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from rthm_analysis.diagnosis.replay.compiled import compiled, inlined
from rthm_core.clock import NS
from rthm_core.compiled import Floats, Integers
from rthm_core.physical.drive import RATE, Drive, accepted, drive
from rthm_core.spec.effect import sizes

if TYPE_CHECKING:
    from rthm_core.spec import Spec


Complex = npt.NDArray[np.complex128]
"""Array of modes; shapes are in the docstrings."""

POLES_NEAR, POLES_APART = 1e-5, 1e-7
"""Difference of two poles, over their size, below which they coincide, and by which they then differ."""


def motor_delay(spec: Spec) -> int:
    """Delay of the motors beside tau4, in ns."""
    return round(sum(sizes(spec.effects, "motor", "delay")) * NS)


def drive_speed(spec: Spec) -> float:
    """Fastest motion of the motors, rad/s; 0 where they follow at once."""
    a = drive(spec).system.a
    return float(np.abs(np.linalg.eigvals(a)).max()) if a.size else 0.0


def motor_motion(spec: Spec, time_ns: Integers, due_ns: Integers, commands: Floats, first: Floats) -> Floats:
    """Motor positions (g, 3, m) at the start, middle and end of each interval of a grid, in m.

    Parameters
    ----------
    spec : Spec
        Gives poles and motor effects, but for `motor_delay`.
    time_ns : (g,) array
        Grid.
    due_ns : (c,) array
        Instants at which the commands reach the motors, ascending; instants of the grid.
    commands : (c, m) array
        In m.
    first : (m,) array
        Command in steady state before.
    """
    motors = drive(spec)
    modes, vectors, entry = _modes(motors)
    taken = _taken(motors, due_ns, commands, first)
    nq = modes.size
    result = np.zeros((time_ns.size, 3, first.size))
    _run(
        time_ns,
        due_ns,
        taken,
        motors.conditioning[RATE],
        modes,
        np.ascontiguousarray(entry),
        np.ascontiguousarray(motors.out[:, :nq] @ vectors),
        np.ascontiguousarray(motors.out[:, nq:]),
        result,
        _working(first.size, nq),
    )
    return result


def held_motion(
    spec: Spec, at_ns: Integers, due_ns: Integers, commands: Floats, first: Floats
) -> Floats | None:
    """Positions (s, m) at some instants (s,) of motors that follow their commands at once, in m; None where
    they do not.

    As `motor_motion` has them, but read off, with no way between.
    """
    motors = drive(spec)
    if motors.system.a.size or np.isfinite(motors.conditioning[RATE]).any():
        return None
    row = np.searchsorted(due_ns, at_ns, side="right")
    return np.asarray(_taken(motors, due_ns, commands, first)[row] @ motors.out.T)


def _taken(motors: Drive, due_ns: Integers, commands: Floats, first: Floats) -> Floats:
    """Commands (c + 1, m) as the motors take them, behind that in steady state before."""
    return accepted(motors, np.vstack([first[None], commands]), np.append(0.0, due_ns * 1e-9))


def _modes(motors: Drive) -> tuple[Complex, Complex, Complex]:
    """Eigenvalues (nq,) and vectors (nq, nq) of the motor chain, and what commands do to its modes (nq, m).

    Poles that coincide are moved apart by a hair: every state gets that much faster, and rests where it did.
    """
    a, b = motors.system.a.astype(complex), motors.system.b.astype(complex)
    modes, vectors = np.linalg.eig(a)
    if _nearest(modes) < POLES_NEAR:
        faster = (1.0 + POLES_APART * np.arange(modes.size))[:, None]
        modes, vectors = np.linalg.eig(faster * a)
        b = faster * b
    return modes, vectors, np.linalg.solve(vectors, b)


def _nearest(modes: Complex) -> float:
    """Smallest distance of two modes, over the size of one of them; infinite where there is one at most."""
    size = np.abs(modes)
    apart = np.abs(modes[:, None] - modes) / np.minimum(size[:, None], size)
    return float(apart[~np.eye(modes.size, dtype=bool)].min(initial=np.inf))


class _Working(NamedTuple):
    """Commands (m,): the target, the present one, that half an interval later, the time to the target, the
    integral over half an interval and over all of it; modes (nq,): their state, its integral, what half an
    interval does to them.
    """

    target: Floats
    now: Floats
    later: Floats
    arrival: Floats
    integral: Floats
    whole: Floats
    q: Complex
    travelled: Complex
    step: Complex
    level: Complex
    slope: Complex


def _working(m: int, nq: int) -> _Working:
    commands: Any = (np.zeros(m) for _ in range(6))
    modes: Any = (np.zeros(nq, complex) for _ in range(5))
    return _Working(*commands, *modes)


@compiled
def _run(
    time_ns: Integers,
    due_ns: Integers,
    commands: Floats,
    rate: Floats,
    modes: Complex,
    entry: Complex,
    row: Complex,
    through: Floats,
    out: Floats,
    working: _Working,
) -> None:
    target, now, later, arrival, integral, whole, q, travelled, step, level, slope = working
    m, nq = commands.shape[1], modes.size
    moves = nq > 0
    for k in range(m):
        moves = moves or rate[k] < np.inf
        target[k] = now[k] = later[k] = commands[0, k]
        for i in range(nq):
            q[i] -= entry[i, k] * now[k] / modes[i]
    j, length = 0, 0.0
    for g in range(time_ns.size):
        while j < due_ns.size and due_ns[j] <= time_ns[g]:
            for k in range(m):
                target[k] = commands[j + 1, k]
            j += 1
        for k in range(m):
            if rate[k] == np.inf:
                now[k] = target[k]
        if not moves:
            for part in range(3):
                _read(row, through, q, now, out, g, part)
            continue
        half = 0.5e-9 * (time_ns[g + 1] - time_ns[g]) if g + 1 < time_ns.size else 0.0
        for i in range(nq):
            travelled[i] = 0.0
            if half != length and half > 0.0:  # most intervals are as long as the one before
                step[i] = np.exp(modes[i] * half)
                level[i] = (step[i] - 1.0) / modes[i]
                slope[i] = (level[i] - half) / modes[i]
        length = half
        for k in range(m):
            whole[k] = 0.0
        for part in range(3):
            _read(row, through, q, now, out, g, part)
            if part == 2 or half == 0.0:
                continue
            for k in range(m):
                reach, gap = rate[k] * half, target[k] - now[k]
                later[k] = now[k] + min(max(gap, -reach), reach)
                integral[k] = 0.5 * (now[k] + later[k]) * half
                arrival[k] = abs(gap) / rate[k]
                if arrival[k] < half:  # and stays
                    integral[k] = target[k] * half - 0.5 * gap * arrival[k]
                whole[k] += integral[k]
            for i in range(nq):
                before, entered = q[i], 0.0j
                q[i] *= step[i]
                for k in range(m):
                    if 0.0 < arrival[k] < half:
                        gap = target[k] - now[k]
                        driven = level[i] * target[k] - gap * _short_of(modes[i], arrival[k], half)
                    else:
                        driven = level[i] * now[k] + slope[i] * (later[k] - now[k]) / half
                    q[i] += entry[i, k] * driven
                    entered += entry[i, k] * integral[k]
                travelled[i] += (q[i] - before - entered) / modes[i]
            for k in range(m):
                now[k] = later[k]
        if half > 0.0:
            for i in range(nq):
                travelled[i] /= 2.0 * half
            for k in range(m):
                whole[k] /= 2.0 * half
            _mean_kept(row, through, travelled, whole, out, g)


@inlined
def _short_of(mode, arrival, length):  # type: ignore[no-untyped-def]
    """What a mode lacks after some time since a command was not at its target at once.

    The command starts 1 short of it, goes there at a constant rate until its arrival, and stays.
    """
    level = (np.exp(mode * arrival) - 1.0) / mode
    return np.exp(mode * (length - arrival)) * (level - (level - arrival) / (mode * arrival))


@inlined
def _read(row, through, q, command, out, g, part):  # type: ignore[no-untyped-def]
    """Motor positions from the modes and the commands."""
    for k in range(command.size):
        u = 0.0
        for i in range(command.size):
            u += through[k, i] * command[i]
        for i in range(q.size):
            u += (row[k, i] * q[i]).real
        out[g, part, k] = u


@inlined
def _mean_kept(row, through, mean, command, out, g):  # type: ignore[no-untyped-def]
    """Choose the middle so that the parabola through start, middle and end has the exact mean."""
    for k in range(command.size):
        u = 0.0
        for i in range(mean.size):
            u += (row[k, i] * mean[i]).real
        for i in range(command.size):
            u += through[k, i] * command[i]
        out[g, 1, k] = (6.0 * u - out[g, 0, k] - out[g, 2, k]) / 4.0
