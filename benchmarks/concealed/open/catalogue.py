"""All names of cases, by class."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from benchmarks.concealed.open import clean, elsewhere, listed, parameters, spoiled, unlisted
from benchmarks.concealed.open.draft import Draft

Recipe = Callable[[np.random.Generator, float], Draft]
CLASSES: dict[str, dict[str, Recipe]] = {
    "unlisted": {name: unlisted.plant_law(name) for name in unlisted.PLANT} | elsewhere.RECIPES,
    "spoiled": spoiled.RECIPES,
    "parameters": parameters.RECIPES,
    "listed": listed.RECIPES,
    "clean": clean.RECIPES,
}
RECIPES: dict[str, Recipe] = {name: recipe for c in CLASSES.values() for name, recipe in c.items()}


def class_of(name: str) -> str:
    """Class of a case."""
    return next(c for c, recipes in CLASSES.items() if name in recipes)
