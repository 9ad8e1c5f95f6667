"""Stable hybrid tests drawn at random: two masses, one actuator, clocks, delays, loads."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
from benchmarks.concealed.loop import TRUE
from benchmarks.concealed.simulate import run
from benchmarks.concealed.world import NO_SINES, HybridTest

PILOT = 40.0  # s, length of the run that judges stability and size of motion
ROUGH = 4e-4  # s, its longest step of integration
LOADS = ("plant", "numerical", "both", "harmonic", "none")
SHARES = (0.4, 0.15, 0.25, 0.08, 0.12)  # of tests under these loads


def draw_test(rng: np.random.Generator, transmission: bool) -> tuple[HybridTest, np.ndarray]:
    """Draw tests until one is stable.

    Returns
    -------
    HybridTest
        Without effects; its spec is the nominal one.
    ndarray, shape (n1, 4)
        Its x1, v1, u, F without noise, over `PILOT` seconds.
    """
    while True:
        test = HybridTest(_spec(rng, transmission))
        if not _stable(test):
            continue
        _load(test, rng)
        pilot = _try(test)
        if np.abs(pilot[:, 0]).max() < 1.0:
            return test, pilot


def _between(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw evenly on a logarithmic scale, four digits kept."""
    return float(f"{np.exp(rng.uniform(np.log(low), np.log(high))):.4g}")


def _substructure(rng: np.random.Generator) -> dict[str, Any]:
    mass, frequency = _between(rng, 0.5, 5.0), _between(rng, 1.8, 6.0)
    damping = 2.0 * _between(rng, 0.003, 0.03) * mass * frequency
    return {
        "mass": [mass],
        "damping": [float(f"{damping:.4g}")],
        "stiffness": [float(f"{mass * frequency**2:.4g}")],
    }


def _actuator(rng: np.random.Generator, transmission: bool) -> dict[str, Any]:
    actuator: dict[str, Any] = {"names": ["a1"], "compensator": "none"}
    if transmission:
        actuator["transmission"] = {
            "spring": _between(rng, 0.3, 2.0), "wire": _between(rng, 60.0, 150.0), "radius": 0.05,
            "inertia": _between(rng, 5e-6, 2e-5), "damping": _between(rng, 1e-4, 5e-4),
        }  # fmt: skip
    else:
        actuator["stiffness"] = [_between(rng, 25.0, 120.0)]
    if rng.random() < 0.5:
        actuator["motor_poles"] = [_between(rng, 200.0, 800.0), _between(rng, 1000.0, 3000.0)]
    return actuator


def _timing(rng: np.random.Generator) -> dict[str, float]:
    """Clocks and delays, most on a grid of 0.1 ms as in a paper, some to the microsecond."""
    digits = 4 if rng.random() < 0.7 else 6
    ranges = {
        "td1": (0.001, 0.002), "td2": (0.006, 0.015), "td3": (0.002, 0.006),
        "tau1": (0.001, 0.006), "tau2": (0.003, 0.012), "tau3": (0.003, 0.014), "tau4": (0.003, 0.012),
    }  # fmt: skip
    timing = {k: round(float(rng.uniform(*v)), digits) for k, v in ranges.items()}
    return timing | {"td4": 0.0}


def _spec(rng: np.random.Generator, transmission: bool) -> dict[str, Any]:
    spec: dict[str, Any] = {
        "plant": {"dofs": ["x1"]} | _substructure(rng),
        "numerical": {"dofs": ["x2"]} | _substructure(rng),
        "interface": {
            "plant_dof": ["x1"],
            "numerical_dof": ["x2"],
            "stiffness": [_between(rng, 2.0, 15.0)],
            "damping": [_between(rng, 0.02, 0.3)],
        },
        "actuator": _actuator(rng, transmission),
        "timing": _timing(rng),
        "noise": {"position": 1e-4, "velocity": 2e-3, "motor": 1e-5, "force": 0.02},
    }
    spec["plant"] |= {"initial_position": [round(float(rng.uniform(0.1, 0.5)), 3)], "initial_velocity": [0.0]}
    spec["numerical"] |= {"initial_position": [0.0], "initial_velocity": [0.0]}
    return spec


def _try(test: HybridTest) -> np.ndarray:
    """x1, v1, u, F of a rough run without noise."""
    return run(test, PILOT, 0, noisy=False, step=ROUGH).plant[:, TRUE]


def _stable(test: HybridTest) -> bool:
    """Whether the free motion dies out: its last quarter is below 0.7 of its first."""
    motion = _try(test)[:, 0]
    first, last = np.array_split(motion, 4)[0], np.array_split(motion, 4)[3]
    return bool(np.isfinite(last).all() and last.std() < 0.7 * first.std())


def _sines(rng: np.random.Generator, count: int) -> np.ndarray:
    """Unit multisine: one line in each of `count` equal bands from 1 to 12 ... 25 rad/s."""
    edges = np.linspace(1.0, rng.uniform(12.0, 25.0), count + 1)
    frequency = rng.uniform(edges[:-1], edges[1:])
    return np.stack(
        [np.full(count, np.sqrt(2.0 / count)), frequency, rng.uniform(0.0, 2.0 * np.pi, count)], axis=1
    )


def _load(test: HybridTest, rng: np.random.Generator) -> None:
    """Draw the known loads and scale them so that x1 moves by 0.03 to 0.12 m rms."""
    kind = rng.choice(LOADS, p=SHARES)
    if kind == "none":
        return
    test.spec["plant"]["initial_position"] = [round(float(rng.uniform(0.0, 0.2)), 3)]
    count = 1 if kind == "harmonic" else int(rng.integers(10, 25))
    side = rng.choice(["plant", "numerical", "both"]) if kind == "harmonic" else kind
    test.sines1 = _sines(rng, count) if side in ("plant", "both") else NO_SINES
    test.sines2 = _sines(rng, count) if side in ("numerical", "both") else NO_SINES
    if kind != "harmonic":
        test.ramp1 = test.ramp2 = 2.0
    _scale(test, rng.uniform(0.03, 0.12))
    if kind == "harmonic":
        _declare(test)


def _scale(test: HybridTest, target: float) -> None:
    """Scale the loads by what they alone do."""
    quiet = HybridTest(copy.deepcopy(test.spec), test.sines1, test.ramp1, test.sines2, test.ramp2)
    quiet.spec["plant"]["initial_position"] = [0.0]
    factor = target / _try(quiet)[:, 0].std()
    for sines in (test.sines1, test.sines2):
        sines[:, 0] = [float(f"{a:.4g}") for a in factor * sines[:, 0]]


def _declare(test: HybridTest) -> None:
    """Write a harmonic load into the spec; a multisine is known from the recording alone."""
    for part, dof, sines in (("plant", "x1", test.sines1), ("numerical", "x2", test.sines2)):
        if len(sines):
            amplitude, frequency, phase = (float(v) for v in sines[0])
            test.spec.setdefault("load", {})[part] = {
                "dof": dof,
                "kind": "harmonic",
                "amplitude": amplitude,
                "frequency": frequency,
                "phase": phase,
            }
