"""Replay of plant and wire on a time grid: compiled, and fast enough to be run thousands of times.

The simulator locates every switch exactly and adapts its step. A diagnosis compares with noise, so it may
take the steps that the recording gives (Runge-Kutta of fourth order between the instants at which something
comes in), and put only the turning points of dry friction where they belong. Laws of force are the
simulator's own.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.replay.compiled import compiled, inlined
from rthm_analysis.diagnosis.replay.mechanics import Mechanics
from rthm_analysis.diagnosis.replay.rates import nonlinear_wire, product, rate, settle_wires
from rthm_analysis.diagnosis.replay.switching import (
    break_away,
    first_modes,
    first_switch,
    guards,
    sharpened,
    switch,
)
from rthm_core.compiled import Floats, Integers
from rthm_core.physical.laws import NONLINEAR

MOST_SWITCHES = 20
"""Switches within one interval that are followed; further ones wait for the next."""


@inlined
def _at(motor, load, g, share, u, w):  # type: ignore[no-untyped-def]
    """Motor positions and loads within interval `g`, from their values at its start, middle and end."""
    first = (1.0 - share) * (1.0 - 2.0 * share)
    middle, last = 4.0 * share * (1.0 - share), share * (2.0 * share - 1.0)
    for i in range(u.size):
        u[i] = first * motor[g, 0, i] + middle * motor[g, 1, i] + last * motor[g, 2, i]
    for i in range(w.size):
        w[i] = first * load[g, 0, i] + middle * load[g, 1, i] + last * load[g, 2, i]


@inlined
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
    modes,
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
        rate(
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
            modes,
            stages[stage],
            hold,
            z,
        )
    for i in range(ny):
        slope = stages[0, i] + 2.0 * stages[1, i] + 2.0 * stages[2, i] + stages[3, i]
        point[i] = y[i] + h * slope / 6.0


@inlined
def _between(share, h, y, point, begin, end, out):  # type: ignore[no-untyped-def]
    """State within a step, from the states and their rates at both ends (cubic of Hermite)."""
    rest = 1.0 - share
    first, last = rest * rest * (1.0 + 2.0 * share), share * share * (3.0 - 2.0 * share)
    for i in range(out.size):
        slopes = h * share * rest * (rest * begin[i] - share * end[i])
        out[i] = first * y[i] + last * point[i] + slopes


class Working(NamedTuple):
    """Scratch of a replay.

    Attributes
    ----------
    y, point, z, scratch, seen, slope : (ny,) arrays
    stages : (4, ny) array
    u, w : (m,), (n,) arrays
    hold, held : (R,) arrays
    modes : (R,) array
    """

    y: Floats
    point: Floats
    z: Floats
    scratch: Floats
    seen: Floats
    slope: Floats
    stages: Floats
    u: Floats
    w: Floats
    hold: Floats
    held: Floats
    modes: Integers


def working(mechanics: Mechanics) -> Working:
    """Scratch for these mechanics."""
    ny, rows = mechanics.initial.size, mechanics.laws.shape[0]
    return Working(
        *(np.zeros(ny) for _ in range(6)),
        stages=np.zeros((4, ny)),
        u=np.zeros(mechanics.wires.shape[0]),
        w=np.zeros(mechanics.inverse_mass.shape[0]),
        hold=np.zeros(rows),
        held=np.zeros(rows),
        modes=np.zeros(rows, dtype=np.int64),
    )


@compiled
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
    working: Working,
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
    working : Working
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
    y, point, z, scratch, seen, slope, stages, u, w, hold, held, modes = working
    n, m, ny, rows = inverse_mass.shape[0], motor.shape[2], initial.size, laws.shape[0]
    for i in range(ny):
        y[i] = initial[i]
    s, r = 0, 0
    for g in range(time.size):
        last = g == time.size - 1
        whole = 1e-9 if last else time[g + 1] - time[g]
        if r < start.size and start[r] == g:
            for i in range(2 * n):
                y[i] = state[r, i]
            first_modes(n, laws, thresholds, y, modes)
            r += 1
        done, length, still = 0.0, whole / substeps, 0
        for _ in range(substeps + MOST_SWITCHES + 1):
            if not done < whole * (1.0 - 1e-9):
                break
            t, h = time[g] + done, min(length, whole - done)
            _at(motor, load, g, 0.0 if last else done / whole, u, w)
            settle_wires(n, wires, stiffness, drive, wire_laws, wire_parameters, y, u, z, scratch)
            rate(
                n, a, b, inverse_mass, wires, stiffness, drive, wire_laws, wire_parameters,
                laws, parameters, thresholds, y, u, w, t, modes, stages[0], hold, z,
            )  # fmt: skip
            if rows and break_away(laws, breakaway, modes, hold):
                rate(
                    n, a, b, inverse_mass, wires, stiffness, drive, wire_laws, wire_parameters,
                    laws, parameters, thresholds, y, u, w, t, modes, stages[0], hold, z,
                )  # fmt: skip
            _step(
                n, a, b, inverse_mass, wires, stiffness, drive, wire_laws, wire_parameters,
                laws, parameters, thresholds, y, motor, load, g, done, whole, t, h, u, w,
                modes, stages, point, hold, z,
            )  # fmt: skip
            law = -1
            if rows and still < MOST_SWITCHES:
                share, law = first_switch(n, laws, thresholds, modes, y, point)
                if law >= 0:
                    before, after = guards(n, laws, thresholds, modes, law, y, point)
                    for _ in range(2):
                        _step(
                            n, a, b, inverse_mass, wires, stiffness, drive, wire_laws, wire_parameters,
                            laws, parameters, thresholds, y, motor, load, g, done, whole, t, share * h, u, w,
                            modes, stages, point, hold, z,
                        )  # fmt: skip
                        _, here = guards(n, laws, thresholds, modes, law, y, point)
                        closer = sharpened(share, before, here, after)
                        if abs(closer - share) < 1e-6:
                            break
                        share = closer
                    h *= share
                    _step(
                        n, a, b, inverse_mass, wires, stiffness, drive, wire_laws, wire_parameters,
                        laws, parameters, thresholds, y, motor, load, g, done, whole, t, h, u, w,
                        modes, stages, point, hold, z,
                    )  # fmt: skip
            until = np.inf if last else time[g + 1] if done + h >= whole * (1.0 - 1e-9) else t + h
            if s < sample.size and sample[s] < until:
                _at(motor, load, g, (done + h) / whole, u, w)
                rate(
                    n, a, b, inverse_mass, wires, stiffness, drive, wire_laws, wire_parameters,
                    laws, parameters, thresholds, point, u, w, t + h, modes, slope, held, z,
                )  # fmt: skip
            while s < sample.size and sample[s] < until:
                share = 0.0 if last or h <= 0.0 else min(max((sample[s] - t) / h, 0.0), 1.0)
                _between(share, h, y, point, stages[0], slope, seen)
                for i in range(m):
                    u[i] = seen_motor[s, i]
                for i in range(n):
                    out[s, i], out[s, n + i] = seen[i], seen[n + i]
                for actuator in range(m):
                    if wires[actuator, NONLINEAR]:
                        for i in range(2 * n, ny):
                            seen[i] = y[i]
                        out[s, 2 * n + actuator] = nonlinear_wire(
                            actuator, n, wires, stiffness, drive, wire_laws, wire_parameters,
                            seen, u, z, scratch, False,
                        )  # fmt: skip
                    else:
                        out[s, 2 * n + actuator] = product(wire_force[actuator], seen, u)
                s += 1
            if s == sample.size:
                return
            for i in range(ny):
                y[i] = point[i]
            if law >= 0:
                switch(n, laws, modes, y, law)
                still += 1
            done += h
            if not last:
                _at(motor, load, g, min(done / whole, 1.0), u, w)
                settle_wires(n, wires, stiffness, drive, wire_laws, wire_parameters, y, u, z, scratch)
