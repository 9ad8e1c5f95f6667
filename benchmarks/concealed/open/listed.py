"""Cases with one to three kinds of the library, on other rigs and scales."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from benchmarks.concealed.kinds import CATALOGUE, LINKS, SENSORS
from benchmarks.concealed.open.draft import Draft, open_draft
from benchmarks.concealed.open.worlds import UNITS, draw_loop, draw_plain

Recipe = Callable[[np.random.Generator, float], Draft]
PLANT = tuple(kind for block, kind in CATALOGUE if block == "plant" and kind != "constant_load")
OTHERS = tuple(key for key in CATALOGUE if key[0] != "plant")
TRIPLES = (
    ("plant coulomb_friction", "plant quadratic_drag", "plant cubic_stiffness"),
    ("plant coulomb_friction", "plant quadratic_drag", "plant quadratic_stiffness"),
    ("plant coulomb_friction", "plant cubic_stiffness", "plant end_stop"),
    ("plant quadratic_drag", "plant cubic_stiffness", "plant maxwell_branch"),
    ("plant coulomb_friction", "plant cubic_stiffness", "wire hardening"),
    ("plant quadratic_drag", "plant cubic_stiffness", "wire backlash"),
    ("plant quadratic_drag", "plant quadratic_stiffness", "motor extra_delay"),
)
PAIRS = tuple(dict.fromkeys(t[i : i + 2] for t in TRIPLES for i in (0, 1)))


def _world(rng: np.random.Generator, plain: bool, boost: float) -> Draft:
    """A plant alone, or a hybrid test at another scale than the paper's."""
    rigs = [name for name in UNITS if name != "paper"]
    return open_draft(rng, draw_plain(rng) if plain else draw_loop(rng, rig=str(rng.choice(rigs))), boost)


def single_in_plant(rng: np.random.Generator, boost: float) -> Draft:
    """One kind of the plant, in a plant alone."""
    draft = _world(rng, True, boost)
    draft.conceal_kind("plant", str(rng.choice(PLANT)), draft.size(0.03, 0.2))
    draft.measure = "force"
    return draft


def single_in_loop(rng: np.random.Generator, boost: float) -> Draft:
    """One kind of any block, in a hybrid test."""
    draft = _world(rng, False, boost)
    block, kind = OTHERS[rng.integers(len(OTHERS))]
    block = str(rng.choice({"link.*": LINKS, "sensor.*": SENSORS}.get(block, (block,))))
    draft.conceal_kind(block, kind, min(draft.size(0.03, 0.15), 0.3))
    draft.measure = "effects"
    return draft


def several(choices: tuple[tuple[str, ...], ...]) -> Recipe:
    """Return the recipe of two or three kinds at once."""

    def recipe(rng: np.random.Generator, boost: float) -> Draft:
        names = choices[rng.integers(len(choices))]
        plain = all(n.startswith("plant") for n in names) and rng.random() < 0.6
        draft = _world(rng, plain, boost)
        for name in names:
            block, kind = name.split()
            draft.conceal_kind(block, kind, draft.size(0.05, 0.2))
        draft.measure = "each"
        return draft

    return recipe


RECIPES: dict[str, Recipe] = {
    "single_in_plant": single_in_plant,
    "single_in_loop": single_in_loop,
    "pair": several(PAIRS),
    "triple": several(TRIPLES),
}
