"""Replay of plant and wire on a time grid: compiled, and fast enough to be run thousands of times.

The simulator locates every switch exactly and adapts its step. A diagnosis compares with noise, so it may
take the steps that the recording gives (Runge-Kutta of fourth order between the instants at which something
comes in), and put only the turning points of dry friction where they belong. Laws of force are the
simulator's own.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np

from rthm_core.compiled import Floats, Integers
from rthm_core.physical.laws import (
    CODE,
    DOF,
    NONLINEAR,
    PLACE,
    SPLIT,
    STATE,
    STATES,
    plant_force,
    plant_rate,
    wire_drive,
    wire_law_force,
    wire_rate,
    wire_settle,
)

POSITION, FRICTION = 1, 3
"""How the pieces of a law meet; indices into ``rthm_core.physical.laws.SPLITS``."""

MOST_SWITCHES = 20
"""Switches within one interval that are followed; further ones wait for the next."""

_inline = numba.njit(inline="always", error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)


class Mechanics(NamedTuple):
    """Plant and wires as arrays; see ``rthm_core.physical`` for the meaning of the tables.

    Attributes
    ----------
    a : (ny, ny) array
        Linear mechanics.
    b : (ny, m + n + m + r) array
        Effect on dy/dt of motor positions, loads on the dofs, forces of nonlinear wires, of nonlinear laws.
    inverse_mass : (n, n) array
    wires : (m, 3) integers
    stiffness : (m, 2) array
    drive, force : (m, ny + m) arrays
    wire_laws, wire_parameters : (W, 4), (W, 8) arrays
    laws, parameters, thresholds, breakaway : (R, 5), (R, 8), (R, 2), (R,) arrays
    initial : (ny,) array
    """

    a: Floats
    b: Floats
    inverse_mass: Floats
    wires: Integers
    stiffness: Floats
    drive: Floats
    force: Floats
    wire_laws: Integers
    wire_parameters: Floats
    laws: Integers
    parameters: Floats
    thresholds: Floats
    breakaway: Floats
    initial: Floats


@_inline
def _product(row, y, u):  # type: ignore[no-untyped-def]
    total = 0.0
    for j in range(y.size):
        total += row[j] * y[j]
    for j in range(u.size):
        total += row[y.size + j] * u[j]
    return total


@_inline
def _curved_wire(actuator, n, wires, stiffness, drive, wire_laws, wire_parameters, y, u, z, dy, commit):  # type: ignore[no-untyped-def]
    """Force of a nonlinear wire; `z` is scratch, and gets into `y` the settled states when `commit`."""
    k, dof = stiffness[actuator, 0], wires[actuator, DOF]
    x, v = y[dof], y[n + dof]
    position = _product(drive[actuator], y, u)
    for row in range(wire_laws.shape[0]):
        if wire_laws[row, PLACE] == actuator:
            begin, end = wire_laws[row, STATE], wire_laws[row, STATE] + wire_laws[row, STATES]
            z[begin:end] = y[begin:end]
            wire_settle(wire_laws[row, CODE], position, x, k, z[begin:end], wire_parameters[row])
            position = wire_drive(wire_laws[row, CODE], position, z[begin:end], wire_parameters[row])
    force = k * (position - x)
    for row in range(wire_laws.shape[0]):
        if wire_laws[row, PLACE] == actuator:
            begin, end = wire_laws[row, STATE], wire_laws[row, STATE] + wire_laws[row, STATES]
            p, own = wire_parameters[row], z[begin:end]
            force = wire_law_force(wire_laws[row, CODE], position, x, v, k, force, own, p)
            wire_rate(wire_laws[row, CODE], position, x, v, k, own, p, dy[begin:end])
            if commit:
                y[begin:end] = own
    return force


@_inline
def _piece(row, laws, thresholds, x, v):  # type: ignore[no-untyped-def]
    """Piece of a law that is no dry friction."""
    if laws[row, SPLIT] == POSITION:
        return (1 if x > thresholds[row, 0] else 0) + (1 if x > thresholds[row, 1] else 0)
    return 1 if v >= 0.0 else -1


@_inline
def _hold(m, n, b, inverse_mass, laws, pieces, dy, hold, sticking):  # type: ignore[no-untyped-def]
    """Forces that keep the sticking dofs at rest together, by sweeps over them."""
    for _ in range(1 if sticking == 1 else 200):
        change = 0.0
        for row in range(laws.shape[0]):
            if laws[row, SPLIT] == FRICTION and pieces[row] == 0:
                dof = laws[row, PLACE]
                force = -dy[n + dof] / inverse_mass[dof, dof]
                hold[row] += force
                change = max(change, abs(force) - 1e-12 * abs(hold[row]))
                for i in range(dy.size):
                    dy[i] += b[i, n + 2 * m + row] * force
                dy[n + dof] = 0.0
        if change <= 0.0:
            return


@_inline
def _rate(
    n,
    a,
    b,
    inverse_mass,
    wires,
    stiffness,
    drive,
    wire_laws,
    wire_parameters,
    laws,
    parameters,
    thresholds,
    y,
    u,
    w,
    t,
    pieces,
    dy,
    hold,
    z,
):  # type: ignore[no-untyped-def]
    """dy/dt; `hold` gets the forces that hold sticking dofs."""
    m = u.size
    for i in range(y.size):
        total = 0.0
        for j in range(y.size):
            total += a[i, j] * y[j]
        for j in range(m):
            total += b[i, j] * u[j]
        for j in range(n):
            total += b[i, m + j] * w[j]
        dy[i] = total
    for actuator in range(m):
        if wires[actuator, NONLINEAR]:
            force = _curved_wire(
                actuator, n, wires, stiffness, drive, wire_laws, wire_parameters, y, u, z, dy, False
            )
            for i in range(y.size):
                dy[i] += b[i, m + n + actuator] * force
    sticking = 0
    for row in range(laws.shape[0]):
        hold[row] = 0.0
        if laws[row, SPLIT] == FRICTION and pieces[row] == 0:
            sticking += 1
            continue
        dof, begin = laws[row, PLACE], laws[row, STATE]
        end = begin + laws[row, STATES]
        x, v, p = y[dof], y[n + dof], parameters[row]
        frozen = laws[row, SPLIT] == FRICTION or laws[row, SPLIT] == POSITION
        piece = pieces[row] if frozen else _piece(row, laws, thresholds, x, v)
        force = plant_force(laws[row, CODE], x, v, y[begin:end], t, p, piece)
        plant_rate(laws[row, CODE], x, v, y[begin:end], t, p, piece, dy[begin:end])
        for i in range(y.size):
            dy[i] += b[i, 2 * m + n + row] * force
    if sticking:
        _hold(m, n, b, inverse_mass, laws, pieces, dy, hold, sticking)


@_inline
def _step(
    n,
    a,
    b,
    inverse_mass,
    wires,
    stiffness,
    drive,
    wire_laws,
    wire_parameters,
    laws,
    parameters,
    thresholds,
    y,
    motor,
    load,
    g,
    begin,
    whole,
    t,
    h,
    u,
    w,
    pieces,
    stages,
    point,
    hold,
    z,
):  # type: ignore[no-untyped-def]
    """Runge-Kutta step of length `h` from `y`, whose rate is in ``stages[0]``; its end is left in `point`."""
    ny = y.size
    for stage in range(1, 4):
        reach = h if stage == 3 else 0.5 * h
        for i in range(ny):
            point[i] = y[i] + reach * stages[stage - 1, i]
        if stage != 2:
            _at(motor, load, g, (begin + reach) / whole, u, w)
        _rate(
            n,
            a,
            b,
            inverse_mass,
            wires,
            stiffness,
            drive,
            wire_laws,
            wire_parameters,
            laws,
            parameters,
            thresholds,
            point,
            u,
            w,
            t + reach,
            pieces,
            stages[stage],
            hold,
            z,
        )
    for i in range(ny):
        slope = stages[0, i] + 2.0 * stages[1, i] + 2.0 * stages[2, i] + stages[3, i]
        point[i] = y[i] + h * slope / 6.0


@_inline
def _margins(n, laws, thresholds, pieces, row, y, end):  # type: ignore[no-untyped-def]
    """How far a law is from leaving its piece at the start and at the end of a step; negative: it has."""
    split, piece = laws[row, SPLIT], pieces[row]
    if split == FRICTION and piece != 0:
        return piece * y[n + laws[row, PLACE]], piece * end[n + laws[row, PLACE]]
    if split == POSITION:
        return _room(thresholds, row, piece, y[laws[row, PLACE]], end[laws[row, PLACE]])
    return 1.0, 1.0


@_inline
def _first_switch(n, laws, thresholds, pieces, y, end):  # type: ignore[no-untyped-def]
    """Share of a step after which the first law leaves its piece, and that law; (1, -1): none does."""
    share, law = 1.0, -1
    for row in range(laws.shape[0]):
        before, after = _margins(n, laws, thresholds, pieces, row, y, end)
        if after < 0.0:
            at = before / (before - after) if before > 0.0 else 0.0
            if at < share:
                share, law = at, row
    return share, law


@_inline
def _sharper(share, before, here, after):  # type: ignore[no-untyped-def]
    """Share of a step at which a margin vanishes, from its values at the start, at `share` and at the end."""
    if here > 0.0 and here > after:
        return share + (1.0 - share) * here / (here - after)
    return share * before / (before - here) if before > here else share


@_inline
def _room(thresholds, row, piece, x0, x1):  # type: ignore[no-untyped-def]
    """Distance to the threshold towards which a motion from x0 to x1 goes, at its start and its end."""
    if piece < 2 and x1 > x0:
        return thresholds[row, piece] - x0, thresholds[row, piece] - x1
    if piece > 0 and x1 < x0:
        return x0 - thresholds[row, piece - 1], x1 - thresholds[row, piece - 1]
    return 1.0, 1.0


@_inline
def _switch(n, laws, pieces, y, row):  # type: ignore[no-untyped-def]
    """Put a law into its next piece; a dry friction sticks."""
    dof = laws[row, PLACE]
    if laws[row, SPLIT] == FRICTION:
        y[n + dof] = 0.0
        pieces[row] = 0
    else:
        pieces[row] += 1 if y[n + dof] > 0.0 else -1


@_inline
def _loosen(laws, breakaway, pieces, hold):  # type: ignore[no-untyped-def]
    """Let go what is held by more than its breakaway force; whether anything was."""
    loose = False
    for row in range(laws.shape[0]):
        if laws[row, SPLIT] == FRICTION and pieces[row] == 0 and abs(hold[row]) > breakaway[row]:
            pieces[row] = -1 if hold[row] > 0.0 else 1
            loose = True
    return loose


@_inline
def _first_pieces(n, laws, thresholds, y, pieces):  # type: ignore[no-untyped-def]
    for row in range(laws.shape[0]):
        x, v = y[laws[row, PLACE]], y[n + laws[row, PLACE]]
        if laws[row, SPLIT] == FRICTION:
            pieces[row] = 1 if v > 0.0 else -1 if v < 0.0 else 0
        else:
            pieces[row] = _piece(row, laws, thresholds, x, v)


@_inline
def _settle(n, wires, stiffness, drive, wire_laws, wire_parameters, y, u, z, scratch):  # type: ignore[no-untyped-def]
    """Bring path-dependent states of the wires up to the present motion."""
    for actuator in range(u.size):
        if wires[actuator, NONLINEAR]:
            _curved_wire(
                actuator, n, wires, stiffness, drive, wire_laws, wire_parameters, y, u, z, scratch, True
            )


@_inline
def _between(share, h, y, point, begin, end, out):  # type: ignore[no-untyped-def]
    """State within a step, from the states and their rates at both ends (cubic of Hermite)."""
    rest = 1.0 - share
    first, last = rest * rest * (1.0 + 2.0 * share), share * share * (3.0 - 2.0 * share)
    for i in range(out.size):
        slopes = h * share * rest * (rest * begin[i] - share * end[i])
        out[i] = first * y[i] + last * point[i] + slopes


@numba.njit(cache=True, nogil=True, error_model="numpy")
def replay_mechanics(
    mechanics: Mechanics,
    time: Floats,
    substeps: int,
    motor: Floats,
    load: Floats,
    start: Integers,
    state: Floats,
    sample: Floats,
    seen_motor: Floats,
    out: Floats,
) -> None:
    """Run over the grid and write the motion at the samples.

    Parameters
    ----------
    mechanics : Mechanics
    time : (g,) array
        Grid, s; its last instant is not before the last sample.
    substeps : int
        Steps per interval of the grid.
    motor : (g, 3, m) array
        Motor positions at the start, middle and end of each interval; jumps are between them. In the last
        row only the start counts.
    load : (g, 3, n) array
        Loads on the dofs, likewise.
    start : (r,) array
        Ascending indices into the grid at which a free run begins, the first of them 0.
    state : (r, 2 n) array
        Positions and velocities there.
    sample : (s,) array
        Ascending instants of the samples, s; one at an instant of the grid sees what comes in there.
    seen_motor : (s, m) array
        Motor positions at the samples.
    out : (s, 2 n + m) array
        Gets positions, velocities and wire forces.
    """
    (
        a,
        b,
        inverse_mass,
        wires,
        stiffness,
        drive,
        wire_force,
        wire_laws,
        wire_parameters,
        laws,
        parameters,
        thresholds,
        breakaway,
        initial,
    ) = mechanics
    n, m, ny, rows = inverse_mass.shape[0], motor.shape[2], initial.size, laws.shape[0]
    y, point, z, scratch, stages = initial.copy(), np.zeros(ny), np.zeros(ny), np.zeros(ny), np.zeros((4, ny))
    seen, slope, held, pieces = np.zeros(ny), np.zeros(ny), np.zeros(rows), np.zeros(rows, dtype=np.int64)
    u, w, hold = np.zeros(m), np.zeros(n), np.zeros(rows)
    s, r = 0, 0
    for g in range(time.size):
        last = g == time.size - 1
        whole = 1e-9 if last else time[g + 1] - time[g]
        if r < start.size and start[r] == g:
            y[: 2 * n] = state[r]
            _first_pieces(n, laws, thresholds, y, pieces)
            r += 1
        done, length, still = 0.0, whole / substeps, 0
        while done < whole * (1.0 - 1e-9):
            t, h = time[g] + done, min(length, whole - done)
            _at(motor, load, g, 0.0 if last else done / whole, u, w)
            _settle(n, wires, stiffness, drive, wire_laws, wire_parameters, y, u, z, scratch)
            _rate(
                n, a, b, inverse_mass, wires, stiffness, drive, wire_laws, wire_parameters,
                laws, parameters, thresholds, y, u, w, t, pieces, stages[0], hold, z,
            )  # fmt: skip
            if rows and _loosen(laws, breakaway, pieces, hold):
                _rate(
                    n, a, b, inverse_mass, wires, stiffness, drive, wire_laws, wire_parameters,
                    laws, parameters, thresholds, y, u, w, t, pieces, stages[0], hold, z,
                )  # fmt: skip
            _step(
                n, a, b, inverse_mass, wires, stiffness, drive, wire_laws, wire_parameters,
                laws, parameters, thresholds, y, motor, load, g, done, whole, t, h, u, w,
                pieces, stages, point, hold, z,
            )  # fmt: skip
            law = -1
            if rows and still < MOST_SWITCHES:
                share, law = _first_switch(n, laws, thresholds, pieces, y, point)
                if law >= 0:
                    before, after = _margins(n, laws, thresholds, pieces, law, y, point)
                    for _ in range(2):
                        _step(
                            n, a, b, inverse_mass, wires, stiffness, drive, wire_laws, wire_parameters,
                            laws, parameters, thresholds, y, motor, load, g, done, whole, t, share * h, u, w,
                            pieces, stages, point, hold, z,
                        )  # fmt: skip
                        _, here = _margins(n, laws, thresholds, pieces, law, y, point)
                        sharper = _sharper(share, before, here, after)
                        if abs(sharper - share) < 1e-6:
                            break
                        share = sharper
                    h *= share
                    _step(
                        n, a, b, inverse_mass, wires, stiffness, drive, wire_laws, wire_parameters,
                        laws, parameters, thresholds, y, motor, load, g, done, whole, t, h, u, w,
                        pieces, stages, point, hold, z,
                    )  # fmt: skip
            until = np.inf if last else time[g + 1] if done + h >= whole * (1.0 - 1e-9) else t + h
            if s < sample.size and sample[s] < until:
                _at(motor, load, g, (done + h) / whole, u, w)
                _rate(
                    n, a, b, inverse_mass, wires, stiffness, drive, wire_laws, wire_parameters,
                    laws, parameters, thresholds, point, u, w, t + h, pieces, slope, held, z,
                )  # fmt: skip
            while s < sample.size and sample[s] < until:
                share = 0.0 if last or h <= 0.0 else min(max((sample[s] - t) / h, 0.0), 1.0)
                _between(share, h, y, point, stages[0], slope, seen)
                u[:] = seen_motor[s]
                for i in range(n):
                    out[s, i], out[s, n + i] = seen[i], seen[n + i]
                for actuator in range(m):
                    if wires[actuator, NONLINEAR]:
                        for i in range(2 * n, ny):
                            seen[i] = y[i]
                        out[s, 2 * n + actuator] = _curved_wire(
                            actuator, n, wires, stiffness, drive, wire_laws, wire_parameters,
                            seen, u, z, scratch, False,
                        )  # fmt: skip
                    else:
                        out[s, 2 * n + actuator] = _product(wire_force[actuator], seen, u)
                s += 1
            if s == sample.size:
                return
            for i in range(ny):
                y[i] = point[i]
            if law >= 0:
                _switch(n, laws, pieces, y, law)
                still += 1
            done += h
            if not last:
                _at(motor, load, g, min(done / whole, 1.0), u, w)
                _settle(n, wires, stiffness, drive, wire_laws, wire_parameters, y, u, z, scratch)


@_inline
def _at(motor, load, g, share, u, w):  # type: ignore[no-untyped-def]
    """Motor positions and loads within interval `g`, from their values at its start, middle and end."""
    first = (1.0 - share) * (1.0 - 2.0 * share)
    middle, last = 4.0 * share * (1.0 - share), share * (2.0 * share - 1.0)
    for i in range(u.size):
        u[i] = first * motor[g, 0, i] + middle * motor[g, 1, i] + last * motor[g, 2, i]
    for i in range(w.size):
        w[i] = first * load[g, 0, i] + middle * load[g, 1, i] + last * load[g, 2, i]
