"""A plant under a known load of several tones, and under another force that no spec holds."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_core.spec import read_spec

MASS, DAMPING, STIFFNESS, NOISE = 1.2, 1.0, 60.0, 2e-4
SPEC = read_spec(f"""/**:
  ros__parameters:
    plant: {{dofs: [x1], mass: [{MASS}], damping: [0.9], stiffness: [62.0], initial_position: [0.05]}}
    uncertainty: {{plant: {{damping: 0.2, stiffness: 0.1}}}}
    noise: {{position: {NOISE}}}
""")
STEP, SAMPLES = 0.004, 10_000
TIME = STEP * np.arange(SAMPLES)
Force = Callable[[float, float, float], float]


def nothing(t: float, x: float, v: float) -> float:
    return 0.0


def recorded(force: Force = nothing) -> Evidence:
    """A plant under a known load of several tones, held between samples, and under another force."""
    rng = np.random.default_rng(5)
    tones = zip(rng.uniform(0.3, 2.5, 12), rng.uniform(0.0, 2.0 * np.pi, 12), strict=True)
    load = sum(0.4 * np.sin(2.0 * np.pi * f * TIME + p) for f, p in tones)
    state, rows = np.array([0.05, 0.0]), []
    for t, known in zip(TIME, np.asarray(load), strict=True):
        rows.append(state[0])
        for part in range(2):
            state = _moved(state, t + part * STEP / 2.0, known, force)
    measured = np.array(rows) + NOISE * rng.normal(size=SAMPLES)
    stamps = np.round(TIME * 1e9).astype(np.int64)
    empty = np.empty(0, dtype=np.int64), np.empty((0, 0))
    position = (Channel("position", "x1"),)
    return Evidence(stamps, *empty, np.asarray(load)[:, None], position, measured[:, None], "force")


def _moved(state: np.ndarray, t: float, known: float, force: Force) -> np.ndarray:
    """The state half a sample later, by Runge and Kutta."""
    step = STEP / 2.0

    def rate(at: float, s: np.ndarray) -> np.ndarray:
        x, v = s
        return np.array([v, (known + force(at, x, v) - DAMPING * v - STIFFNESS * x) / MASS])

    one = rate(t, state)
    two = rate(t + step / 2.0, state + step / 2.0 * one)
    three = rate(t + step / 2.0, state + step / 2.0 * two)
    four = rate(t + step, state + step * three)
    return np.asarray(state + step / 6.0 * (one + 2.0 * two + 2.0 * three + four))
