"""Recordings of a plant alone whose true law is any function, integrated here and not by the product."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from rthm_analysis.diagnosis.fitting.noise import white_noise
from rthm_analysis.diagnosis.missing.curves import Regression
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_core.spec import Spec, spec_from_parameters

MASS, DAMPING, STIFFNESS = 1.2, 0.05, 12.0
STEP, SUBSTEPS = 0.005, 4
NOISE = (1e-4, 2e-3)

Law = Callable[[float, float, float], float]


def plant(start: float = 0.0, **uncertainty: float) -> Spec:
    """Nominal model; what has no uncertainty is exact."""
    section = {
        "dofs": ["x1"],
        "mass": [MASS],
        "damping": [DAMPING],
        "stiffness": [STIFFNESS],
        "initial_position": [start],
        "initial_velocity": [0.0],
    }
    return spec_from_parameters(
        {"plant": section} | ({"uncertainty": {"plant": uncertainty}} if uncertainty else {})
    )


def recorded(
    law: Law = lambda t, x, v: 0.0,
    duration: float = 24.0,
    seed: int = 0,
    force: float = 0.6,
    start: float = 0.0,
    noise: Callable[[np.random.Generator, int], np.ndarray] | None = None,
    damping: float = DAMPING,
    stiffness: float = STIFFNESS,
    mass: Callable[[float, float], float] = lambda t, x: MASS,
) -> Evidence:
    """Position and velocity of m(t, x) a = -c v - k x + load + law(t, x, v), with noise.

    `noise` gives deviates (s, 2) of power 1; white ones by default.
    """
    rng = np.random.default_rng(seed)
    omega, phase = np.sort(rng.uniform(0.5, 8.0, 18)), rng.uniform(0.0, 2.0 * np.pi, 18)

    def load(t: float) -> float:
        return force / 3.0 * float(np.sin(omega * t + phase).sum()) * min(t / 2.0, 1.0)

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        x, v = y
        return np.array([v, (load(t) - damping * v - stiffness * x + law(t, x, v)) / mass(t, x)])

    count, h = round(duration / STEP) + 1, STEP / SUBSTEPS
    y, rows = np.array([start, 0.0]), np.empty((count, 2))
    for i in range(count):
        rows[i] = y
        for j in range(SUBSTEPS):
            t = (i + j / SUBSTEPS) * STEP
            a = rate(t, y)
            b = rate(t + 0.5 * h, y + 0.5 * h * a)
            c = rate(t + 0.5 * h, y + 0.5 * h * b)
            d = rate(t + h, y + h * c)
            y = y + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    deviates = rng.normal(size=(count, 2)) if noise is None else noise(rng, count)
    stamps = np.arange(count) * round(STEP * 1e9)
    loads = np.array([load(i * STEP) for i in range(count)])
    channels = (Channel("position", "x1"), Channel("velocity", "x1"))
    nothing = np.empty(0, dtype=np.int64), np.empty((0, 0))
    return Evidence(stamps, *nothing, loads[:, None], channels, rows + deviates * NOISE, "force")


def wandering(memory: float, share: float) -> Callable[[np.random.Generator, int], np.ndarray]:
    """White noise and `share` times as much that forgets with a time constant of `memory` s."""

    def made(rng: np.random.Generator, count: int) -> np.ndarray:
        pole = np.exp(-STEP / memory)
        drive, rows = rng.normal(size=(count, 2)) * np.sqrt(1.0 - pole**2), np.empty((count, 2))
        state = rng.normal(size=2)
        for i in range(count):
            state = pole * state + drive[i]
            rows[i] = state
        return rng.normal(size=(count, 2)) + share * rows

    return made


def from_rest() -> Windows:
    """One free run over everything, from rest."""
    return Windows(np.array([0]), np.zeros((1, 2)), None)


def left_of(seen: Evidence, scale: float = 1.0, train: int | None = None) -> Regression:
    """What the nominal model leaves of a recording that begins at rest, `scale` times as noisy as usual."""
    noise = white_noise(scale * np.array(NOISE))
    samples = seen.time.size if train is None else train
    return Regression(Experiment(seen, np.empty(0)), from_rest(), noise, Model(plant()), samples)


@cache
def accelerated(
    law: Law = lambda t, x, v: 0.0,
    noise: float = 0.05,
    offset: float = 0.3,
    gain: float = 1.0,
    seed: int = 0,
    **given: float,
) -> Evidence:
    """The same as `recorded`, with an accelerometer behind position and velocity."""
    exact = recorded(law, seed=seed, noise=lambda rng, count: np.zeros((count, 2)), **given)
    x, v = exact.measured.T
    forces = [law(t, *motion) for t, motion in zip(exact.time, exact.measured, strict=True)]
    a = (exact.load[:, 0] - DAMPING * v - STIFFNESS * x + np.array(forces)) / MASS
    deviates = np.random.default_rng(1000 + seed).normal(size=(a.size, 3)) * (*NOISE, noise)
    measured = np.column_stack([x, v, gain * a + offset]) + deviates
    return replace(exact, channels=(*exact.channels, Channel("acceleration", "x1")), measured=measured)
