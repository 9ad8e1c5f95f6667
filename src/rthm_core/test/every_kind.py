"""One effect of every kind in every block, from small to dominating, at amounts drawn with a fixed seed."""

from __future__ import annotations

from functools import cache

import numpy as np
from benchmarks.concealed.amounts import Scene
from benchmarks.concealed.kinds import make_effect

from rthm_core.effects import BLOCKS
from rthm_core.effects.blocks import family
from rthm_core.effects.registry import shipped
from rthm_core.engine import simulate
from rthm_core.errors import InputError
from rthm_core.spec import Spec, apply, shipped_spec

SIZES = {"small": 0.05, "middling": 0.3, "dominating": 1.2}
"""Share of the wire's force (rms) that the effect has, or what moves the motion about as much."""

LOAD = {"dof": "x1", "kind": "multisine", "rms": 0.6, "low": 1.0, "high": 15.0, "count": 15, "seed": 3}
"""Keeps a loop moving, so that each of its effects acts from beginning to end."""

LOOP = apply(shipped_spec("paper"), {"load.plant": LOAD | {"ramp": 0.5}})

TRIES, SMALLER = 100, 0.8
"""How often an amount is drawn until it will do, and how much smaller each is than the one before."""


def places(*families: str) -> list[tuple[str, str]]:
    """Block and kind of every kind that is shipped, of some families of blocks or of all; not of kinds whose
    law is written in the spec.
    """
    blocks = [block for block in BLOCKS if not families or family(block) in families]
    return [(block, law.kind) for block in blocks for law in shipped(block) if not law.written]


def named(place: tuple[str, str]) -> str:
    """Name of a case."""
    return "-".join(place)


def having(base: Spec, block: str, kind: str, size: str, seed: int = 5) -> Spec:
    """A loop with one effect more, called ``one``, whose amount suits its motion; a smaller one where a spec
    may not have it, or it pulls the plant away.
    """
    rng, share = np.random.default_rng(seed), SIZES[size]
    scene = Scene(_sections(base), _motion(base), rng)
    for _ in range(TRIES):
        effect = make_effect(block, kind, share, scene)
        share *= SMALLER
        try:
            spec = apply(base, {"effects": ["one"], "one": effect})
        except InputError:
            continue
        if (
            not _pulls_apart(spec)
            or np.isfinite(simulate(spec, 24.0, 24.0, energies=False).plant_position).all()
        ):
            return spec
    raise AssertionError(f"{block} {kind} of {size} size is nothing that a spec may have")


def _pulls_apart(spec: Spec) -> bool:
    """Whether its effect is a spring that pulls at one side."""
    power = spec.effects[0].law.power
    return power is not None and power % 2 == 0


@cache
def _motion(base: Spec) -> np.ndarray:
    """x1, v1, u, F without the effect: what amounts are scaled by."""
    run = simulate(base, 12.0, 0.01, energies=False)
    x, v, force = run.plant_position[:, 0], run.plant_velocity[:, 0], run.actuator_force[:, 0]
    return np.stack([x, v, x + force / base.k_tot[0], force], axis=1)


def _sections(base: Spec) -> dict[str, dict[str, object]]:
    """Sections of a spec as amounts are scaled by them."""
    loop = base.loop()
    computed = {
        name: {
            key: list(getattr(part, key)) for key in ("mass", "damping", "stiffness") if hasattr(part, key)
        }
        for name, part in (("numerical", loop.numerical), ("interface", loop.interface))
    }
    plant, actuator = {"mass": list(loop.plant.mass)}, {"stiffness": list(base.k_tot)}
    return computed | {"plant": plant, "actuator": actuator}
