"""Motor positions on a time grid, from the commands as they fell due."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba
import numpy as np

from rthm_core.clock import NS
from rthm_core.compiled import Floats, Integers
from rthm_core.physical.drive import LIMIT, QUANTUM, RATE, Drive, drive

if TYPE_CHECKING:
    from rthm_core.spec import Spec


def motor_delay(spec: Spec) -> int:
    """Delay of the motors beside tau4, in ns: the effect ``extra_delay``."""
    delays = [e for e in spec.effects if e.block == "motor" and e.kind == "extra_delay"]
    return round(sum(float(e.parameters["delay"]) for e in delays) * NS)


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
        Command that has been there for ever before.
    """
    motors = drive(spec)
    modes, vectors = _modes(motors)
    accepted = _accepted(np.vstack([first[None], commands]), motors)
    nq = modes.size
    entry = (
        np.linalg.solve(vectors, motors.system.b.astype(complex))
        if nq
        else np.zeros((0, first.size), complex)
    )
    result = np.zeros((time_ns.size, 3, first.size))
    _run(
        time_ns,
        due_ns,
        accepted,
        motors.conditioning[RATE],
        modes,
        np.ascontiguousarray(entry),
        np.ascontiguousarray(motors.out[:, :nq] @ vectors),
        np.ascontiguousarray(motors.out[:, nq:]),
        result,
    )
    return result


def _modes(motors: Drive) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues and vectors of the motor chain; poles that coincide are moved apart by a hair."""
    a = motors.system.a
    if not a.size:
        return np.empty(0, dtype=complex), np.empty((0, 0), dtype=complex)
    spread = np.diag(1.0 + 1e-7 * np.arange(a.shape[0]))
    modes, vectors = np.linalg.eig((a @ spread).astype(complex))
    return modes, vectors


def _accepted(commands: Floats, motors: Drive) -> Floats:
    """Commands (c, m) rounded and cut as the drive takes them."""
    quantum, limit = motors.conditioning[QUANTUM], motors.conditioning[LIMIT]
    steps = np.where(quantum > 0.0, quantum, 1.0)
    rounded = np.where(quantum > 0.0, steps * np.floor(commands / steps + 0.5), commands)
    return np.ascontiguousarray(np.clip(rounded, -limit, limit))


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _run(
    time_ns: Integers,
    due_ns: Integers,
    commands: Floats,
    rate: Floats,
    modes: np.ndarray,
    entry: np.ndarray,
    row: np.ndarray,
    through: Floats,
    out: Floats,
) -> None:
    m, nq = commands.shape[1], modes.size
    target, now, later = commands[0].copy(), commands[0].copy(), commands[0].copy()
    q, travelled = np.zeros(nq, dtype=np.complex128), np.zeros(nq, dtype=np.complex128)
    for i in range(nq):
        for k in range(m):
            q[i] -= entry[i, k] * now[k] / modes[i]
    j = 0
    for g in range(time_ns.size):
        while j < due_ns.size and due_ns[j] <= time_ns[g]:
            target[:] = commands[j + 1]
            j += 1
        for k in range(m):
            if rate[k] == np.inf:
                now[k] = target[k]
        half = 0.5e-9 * (time_ns[g + 1] - time_ns[g]) if g + 1 < time_ns.size else 0.0
        travelled[:] = 0.0
        for part in range(3):
            for k in range(m):
                u = 0.0
                for i in range(m):
                    u += through[k, i] * now[i]
                for i in range(nq):
                    u += (row[k, i] * q[i]).real
                out[g, part, k] = u
            if part == 2 or half == 0.0:
                continue
            for k in range(m):
                reach = rate[k] * half
                later[k] = now[k] + min(max(target[k] - now[k], -reach), reach)
            for i in range(nq):
                step = np.exp(modes[i] * half)
                level = (step - 1.0) / modes[i]
                slope = (level - half) / modes[i]
                before, entered = q[i], 0.0j
                q[i] *= step
                for k in range(m):
                    q[i] += entry[i, k] * (level * now[k] + slope * (later[k] - now[k]) / half)
                    entered += entry[i, k] * 0.5 * (now[k] + later[k]) * half
                travelled[i] += (q[i] - before - entered) / modes[i]
            now[:] = later
        if nq and half > 0.0:
            _mean_kept(row, through, travelled / (2.0 * half), now, out[g])


@numba.njit(nogil=True, error_model="numpy")
def _mean_kept(row: np.ndarray, through: Floats, mean: np.ndarray, command: Floats, out: Floats) -> None:
    """Choose the middle so that the parabola through start, middle and end has the exact mean."""
    for k in range(out.shape[1]):
        u = 0.0
        for i in range(mean.size):
            u += (row[k, i] * mean[i]).real
        for i in range(command.size):
            u += through[k, i] * command[i]
        out[1, k] = (6.0 * u - out[0, k] - out[2, k]) / 4.0
