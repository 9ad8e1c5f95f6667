"""The loop for JiTCDDE: as a delay differential equation with the true sampling, or with mean delays."""

from __future__ import annotations

from typing import Any

import numpy as np
from benchmarks.engine.others import Entry, matrices, mean_delays, start

from rthm_core.clock import to_ns
from rthm_core.compiled import Floats
from rthm_core.spec import Spec

TINY = 1e-9
"""Instants are looked up this much later, so that rounding cannot take a sample before its time."""


def delayed(spec: Spec, duration: float, sample: float, *, sampled: bool, step: float | None = None) -> Entry:
    """JiTCDDE with the holds as delays that grow and jump (`sampled`), or as mean delays.

    With `step` (s) it takes fixed steps, which a user can lay so that they end at every event; without, it
    chooses its own.
    """
    import symengine
    from jitcdde import jitcdde, t, y

    one, b1, two, b2 = matrices(spec)
    y0, force0 = start(spec)
    face, time, k_tot = spec.loop().interface, spec.loop().timing, spec.k_tot[0]

    def held(instant: Any, period: float) -> Any:
        return symengine.floor((instant + TINY) / period) * period

    if sampled:
        to_plant = held(held(t - time.tau4, time.td3) - time.tau1, time.td1)
        ticked = held(t, time.td2)
        to_numerical = held(ticked - time.tau2, time.td1)
        asked = held(t - time.tau4 - time.tau3, time.td2)
        asked_of = held(asked - time.tau2, time.td1)
    else:
        first, second, third = mean_delays(spec)
        to_plant, to_numerical, asked, asked_of = t - first, t - second, t - third, t - third - second
    force = -face.damping[0] * (y(1, asked_of) - y(3, asked)) - face.stiffness[0] * (
        y(0, asked_of) - y(2, asked)
    )
    u = y(0, to_plant) + force / k_tot
    equations = [
        y(1),
        one[1, 0] * y(0) + one[1, 1] * y(1) + b1[1, 0] * u,
        y(3),
        two[1, 0] * y(2) + two[1, 1] * y(3) + b2[1, 0] * y(0, to_numerical) + b2[1, 1] * y(1, to_numerical),
    ]
    system = jitcdde(equations, max_delay=0.2, verbose=False)
    system.compile_C(extra_compile_args=["-O3", "-march=native"])
    system.set_integration_parameters(atol=1e-10, rtol=1e-8)
    rows = to_ns(duration) // to_ns(sample)

    still, command = np.zeros(4), y0[0] + force0 / k_tot
    first_slope = np.concatenate([one @ y0[:2] + b1[:, 0] * command, two @ y0[2:] + b2 @ y0[:2]])

    def call() -> list[Floats]:
        system.purge_past()
        for time, slope in ((-1.0, still), (-1e-9, still), (0.0, first_slope)):
            system.add_past_point(time, y0, slope)
        if step is None:
            found = [y0] + [system.integrate(max(system.t, (i + 1) * sample)) for i in range(rows)]
        else:
            found = [y0] + [system.integrate_blindly((i + 1) * sample, step) for i in range(rows)]
        return found

    return call, lambda found: np.array(found)[:, 0]
