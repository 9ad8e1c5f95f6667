"""One step of a replay, compiled: Runge-Kutta of fourth order, to where a law leaves its mode.

Forces, rates and modes are the simulator's own. The simulator also locates every switch exactly and adapts
its step. A diagnosis compares with noise, so it may take the steps that the recording gives, and put only the
turning points of dry friction and the thresholds of contacts where they belong.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.replay.compiled import inlined
from rthm_analysis.diagnosis.replay.mechanics import Mechanics
from rthm_analysis.diagnosis.replay.switching import first_switch, follow, margins, sharpened
from rthm_core.compiled import Floats, Integers, copy_into
from rthm_core.physical.flow import settle_wires
from rthm_core.physical.integrate import TRIAL, Work, begin_step, rate, work

MOST_TRIALS = 4
"""Steps that are tried to find a switch, with the first, which passes it."""


class Replay(NamedTuple):
    """What is to be replayed: what comes in on a grid, where free runs begin, and what is to be seen.

    Attributes
    ----------
    time : (g,) array
        Grid, s; its last instant is not before the last sample.
    steps : (g,) array
        How many, of one length, each interval takes.
    motor : (g, 3, m) array
        Motor positions at the start, middle and end of each interval; jumps are between them. In the last
        row only the start counts.
    load : (g, 3, loads) array
        Loads, likewise.
    start : (r,) array
        Ascending indices into the grid at which a free run begins, the first of them 0.
    state : (r, 2 n) array
        Positions and velocities there.
    sample : (s,) array
        Ascending instants of the samples, s; one at an instant of the grid sees what comes in there.
    seen_motor : (s, m) array
        Motor positions at the samples.
    """

    time: Floats
    steps: Integers
    motor: Floats
    load: Floats
    start: Integers
    state: Floats
    sample: Floats
    seen_motor: Floats


class Working(NamedTuple):
    """State and scratch of a replay, as `begin_step` takes them.

    Attributes
    ----------
    y, end_rate : (ny,) arrays
        State, and its rate at the end of a step.
    modes : (L,) array
    held : (L + m,) array
        Forces that held sticking dofs at the start of a step, as in `Work`.
    work : Work
    """

    y: Floats
    end_rate: Floats
    modes: Integers
    held: Floats
    work: Work


def working(mechanics: Mechanics) -> Working:
    """Scratch for these mechanics."""
    laws, size = mechanics.laws.numbers.shape[0], mechanics.initial.size
    scratch = work(size, 0, mechanics.m, mechanics.loads, laws + mechanics.m)
    held = np.zeros_like(scratch.hold)
    return Working(np.zeros(size), np.zeros(size), np.zeros(laws, dtype=np.int64), held, scratch)


@inlined
def at(motor, load, g, share, u, w):  # type: ignore[no-untyped-def]
    """Motor positions and loads within interval `g`, from their values at its start, middle and end."""
    first = (1.0 - share) * (1.0 - 2.0 * share)
    middle, last = 4.0 * share * (1.0 - share), share * (2.0 * share - 1.0)
    for i in range(u.size):
        u[i] = first * motor[g, 0, i] + middle * motor[g, 1, i] + last * motor[g, 2, i]
    for i in range(w.size):
        w[i] = first * load[g, 0, i] + middle * load[g, 1, i] + last * load[g, 2, i]


@inlined
def _step(model, replay, working, g, begin, whole, t, h):  # type: ignore[no-untyped-def]
    """Runge-Kutta step of length `h`, whose rate at the start is there; its end is left in row `TRIAL`."""
    y, stages, point = working.y, working.work.stages, working.work.rows[TRIAL]
    for stage in range(1, 4):
        reach = h if stage == 3 else 0.5 * h
        for i in range(y.size):
            point[i] = y[i] + reach * stages[stage - 1, i]
        if stage != 2:
            at(replay.motor, replay.load, g, (begin + reach) / whole, working.work.u, working.work.w)
        follow(model.laws, model.n, point, working.modes, False)
        rate(model, working.modes, working.work, point, t + reach, stages[stage])
    for i in range(y.size):
        slope = stages[0, i] + 2.0 * stages[1, i] + 2.0 * stages[2, i] + stages[3, i]
        point[i] = y[i] + h * slope / 6.0


@inlined
def step_to_switch(model, replay, working, g, begin, whole, t, h, following):  # type: ignore[no-untyped-def]
    """Step of at most `h` from what comes in at its start to where the first law leaves its mode: its length,
    and that law (-1: none, or one that changes at an instant).
    """
    y, end, modes, u = working.y, working.work.rows[TRIAL], working.modes, working.work.u
    at(replay.motor, replay.load, g, begin / whole, u, working.work.w)
    if model.wires.laws.shape[0]:
        settle_wires(model.wires, y, u)
    follow(model.laws, model.n, y, modes, False)
    h = min(h, begin_step(model, working, working.work, t))
    held, hold = working.held, working.work.hold
    copy_into(held, hold)
    law, share, before, after = -1, 1.0, 0.0, 0.0
    for trial in range(MOST_TRIALS):
        _step(model, replay, working, g, begin, whole, t, share * h)
        closer = share
        if trial == 0 and following:
            closer, law = first_switch(model.laws, model.n, modes, y, end, held, hold)
            if law >= 0:
                before, after = margins(model.laws, model.n, modes, law, y, end, held, hold)
        elif law >= 0 and share > 0.0:
            _, here = margins(model.laws, model.n, modes, law, y, end, held, hold)
            closer = sharpened(share, before, here, after)
        if law < 0 or (trial > 0 and abs(closer - share) < 1e-6) or trial == MOST_TRIALS - 1:
            break
        share = closer
    return share * h, law
