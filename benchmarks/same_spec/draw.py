"""Specs with an effect of the plant or the wire, from small to dominating, alone and in a loop."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from benchmarks.concealed.amounts import Scene
from benchmarks.concealed.kinds import CATALOGUE, make_effect

from rthm_core.engine import Trajectory, simulate
from rthm_core.errors import InputError
from rthm_core.spec import Spec, apply, shipped_spec, spec_from_parameters

SIZES = (0.05, 0.3, 1.5)
"""Share of the wire's force (rms) that the effect has; the last dominates."""

PERIODS = (0.001, 0.005)
"""Td1, s."""

DURATION = 24.0
"""Length of a recording, s."""

BOUNDED = 2.0
"""Motion, m, beyond which a draw is no test that anybody would run."""

SMALLER = 0.8
"""Size of each further try over that of the one before: a spring that pulls apart cannot dominate."""

OF_PLANT, OF_WIRE = ([one for one in CATALOGUE if one[0] == block] for block in ("plant", "wire"))


@dataclass(frozen=True)
class Draw:
    """One spec to simulate and to diagnose with."""

    index: int
    seed: int
    block: str
    kind: str
    size: float
    td1: float
    velocity: bool
    in_loop: bool

    def row(self) -> dict[str, Any]:
        """All that says which draw it is."""
        return asdict(self)


def draws(count: int, seed: int) -> list[Draw]:
    """Draws of all combinations in turn: kind, size, period, channels, alone or in the loop."""
    rng = np.random.default_rng(seed)
    made = []
    for index in range(count):
        in_loop, velocity = bool(index % 2), bool(index // 2 % 2)
        kinds = [*OF_PLANT, *OF_WIRE] if in_loop else OF_PLANT
        block, kind = kinds[index // 2 % len(kinds)]
        size, td1 = float(rng.choice(SIZES)), float(rng.choice(PERIODS))
        made.append(Draw(index, int(rng.integers(2**31)), block, kind, size, td1, velocity, in_loop))
    return made


def spec_of(draw: Draw) -> Spec:
    """The spec of a draw, whose motion stays bounded: its effect is smaller where none of its size does."""
    rng, size = np.random.default_rng(draw.seed), draw.size
    while True:
        base = _base(draw, rng)
        scene = Scene(_as_concealed(base), _pilot(base), rng)
        effect = make_effect(draw.block, draw.kind, size, scene)
        size *= SMALLER
        try:
            spec = apply(base, {"effects": ["one"], "one": effect})
            if np.abs(_simulated(spec).plant_position).max() < BOUNDED:
                return spec
        except InputError:
            continue


def _base(draw: Draw, rng: np.random.Generator) -> Spec:
    """A rig without the effect: the paper's, each number up to 1.4 times off, under a multisine."""

    def near(value: float) -> float:
        return float(f"{value * np.exp(rng.uniform(-0.34, 0.34)):.4g}")

    mass, stiffness = near(1.2), near(12.0)
    plant = {"plant.mass": mass, "plant.stiffness": stiffness, "plant.damping": near(0.3)}
    start = {"plant.initial_position": near(0.08)}
    load = {"kind": "multisine", "rms": near(0.6), "low": 1.0, "high": 15.0, "count": 15, "ramp": 2.0}
    load |= {"seed": int(rng.integers(1000))}
    changes = plant | start | {f"load.plant.{key}": value for key, value in load.items()}
    if draw.in_loop:
        return apply(shipped_spec("paper_noisy"), changes | {"timing.td1": draw.td1})
    section = {"dofs": ["x1"], "mass": [1.0], "damping": [0.1], "stiffness": [10.0]}
    section |= {"initial_position": [0.0], "initial_velocity": [0.0]}
    return apply(spec_from_parameters({"plant": section, "noise": _NOISE}), changes)


_NOISE = {"position": 1e-4, "velocity": 2e-3, "force": 0.02, "motor": 1e-5}


def _pilot(spec: Spec) -> np.ndarray:
    """x1, v1, u, F of the rig without the effect; of a plant alone u is at rest and F is its spring's."""
    run = _simulated(spec)
    x, v = run.plant_position[:, 0], run.plant_velocity[:, 0]
    if spec.timing is None:
        return np.stack([x, v, 0.0 * x, spec.plant.stiffness[0] * x], axis=1)
    force = run.actuator_force[:, 0]
    return np.stack([x, v, x + force / spec.k_tot[0], force], axis=1)


def _simulated(spec: Spec) -> Trajectory:
    return simulate(spec, DURATION, 0.01, energies=False)


def _as_concealed(spec: Spec) -> dict[str, Any]:
    """The two sections by which sizes are scaled."""
    stiffness = list(spec.k_tot) if spec.actuator else [1.0]
    return {"plant": {"mass": list(spec.plant.mass)}, "actuator": {"stiffness": stiffness}}
