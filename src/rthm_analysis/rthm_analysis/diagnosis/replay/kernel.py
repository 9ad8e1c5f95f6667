"""Replay of plant and wire on a time grid: compiled, and fast enough to be run thousands of times.

Steps go from instant to instant at which something comes in, and samples are read within them.
"""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.replay.compiled import compiled, inlined
from rthm_analysis.diagnosis.replay.mechanics import Mechanics
from rthm_analysis.diagnosis.replay.steps import Replay, Working, at, step_to_switch, working
from rthm_analysis.diagnosis.replay.switching import follow, switch
from rthm_core.compiled import Floats, copy_into
from rthm_core.energy import cubic, cubic_slope
from rthm_core.physical.flow import product, settle_wires, wire_force
from rthm_core.physical.integrate import POINT, SCRATCH, TRIAL, rate

__all__ = ["Replay", "replay_mechanics", "working"]

SWITCHES_OF_AN_INTERVAL = 20
"""Switches within one interval that are followed; further ones wait for the next."""


@inlined
def _see(model, replay, working, s, t, h, out):  # type: ignore[no-untyped-def]
    """Motion, accelerations and wire forces at sample `s`, in a step of `h` from time `t` on, whose rates
    are there.
    """
    n, m, y, work, stages = model.n, model.m, working.y, working.work, working.work.stages
    seen, end, u = work.rows[POINT], work.rows[TRIAL], replay.seen_motor[s]
    share = min(max((replay.sample[s] - t) / h, 0.0), 1.0) if h > 0.0 else 0.0
    for i in range(y.size):
        first, last = stages[0, i], working.end_rate[i]
        settles = i >= 2 * n and first == 0.0 and last == 0.0  # on the way from the start of the step
        seen[i] = y[i] if settles else cubic(y[i], first, end[i], last, h, share)
    for i in range(2 * n):
        out[s, i] = seen[i]
    for i in range(n, 2 * n):
        out[s, n + i] = cubic_slope(y[i], stages[0, i], end[i], working.end_rate[i], h, share)
    for actuator in range(m):
        if model.wires.laws.shape[0] == 0:  # the call below costs more than all that is seen of a spring
            out[s, 3 * n + actuator] = product(model.wires.force[actuator], seen, u)
        else:
            out[s, 3 * n + actuator] = wire_force(
                model.laws, model.wires, n, seen, u, actuator, work.rows[SCRATCH], stages[1], work.hold
            )


@compiled
def replay_mechanics(model: Mechanics, replay: Replay, out: Floats, working: Working) -> None:
    """Run over the grid and write the motion at the samples.

    Parameters
    ----------
    model : Mechanics
    replay : Replay
    out : (s, 3 n + m) array
        Gets positions, velocities, accelerations and wire forces.
    working : Working
    """
    time, sample, y, end = replay.time, replay.sample, working.y, working.work.rows[TRIAL]
    u, w = working.work.u, working.work.w
    copy_into(y, model.initial)
    s, r = 0, 0
    for g in range(time.size):
        last = g == time.size - 1
        whole = 1e-9 if last else time[g + 1] - time[g]
        if r < replay.start.size and replay.start[r] == g:
            for i in range(2 * model.n):
                y[i] = replay.state[r, i]
            follow(model.laws, model.n, y, working.modes, True)
            r += 1
        done, length, switches = 0.0, whole / replay.steps[g], 0
        for _ in range(replay.steps[g] + SWITCHES_OF_AN_INTERVAL + 1):
            if not done < whole * (1.0 - 1e-9):
                break
            t, h = time[g] + done, min(length, whole - done)
            following = switches < SWITCHES_OF_AN_INTERVAL
            h, law = step_to_switch(model, replay, working, g, done, whole, t, h, following)
            until = np.inf if last else time[g + 1] if done + h >= whole * (1.0 - 1e-9) else t + h
            if s < sample.size and sample[s] < until:
                at(replay.motor, replay.load, g, (done + h) / whole, u, w)
                follow(model.laws, model.n, end, working.modes, False)
                rate(model, working.modes, working.work, end, t + h, working.end_rate)
            while s < sample.size and sample[s] < until:
                _see(model, replay, working, s, t, 0.0 if last else h, out)
                s += 1
            if s == sample.size:
                return
            copy_into(y, end)
            if law >= 0:
                switch(model.laws, model.n, working.modes, y, law, working.work.hold)
                switches += 1
            done += h
            if not last:
                at(replay.motor, replay.load, g, min(done / whole, 1.0), u, w)
                if model.wires.laws.shape[0]:
                    settle_wires(model.wires, y, u)
