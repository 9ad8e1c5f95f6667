"""Cases in which nothing is missing: ugly noise, slow and coarse sensors, other scales, rest."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from benchmarks.concealed.open import noise
from benchmarks.concealed.open.draft import Draft, any_world
from benchmarks.concealed.open.worlds import between

Recipe = Callable[[np.random.Generator, float], Draft]


def plain_noise(rng: np.random.Generator, boost: float) -> Draft:
    """White noise of the usual size."""
    return any_world(rng, boost)


def other_sizes(rng: np.random.Generator, boost: float) -> Draft:
    """White noise, each channel 0.1 to 30 times as loud as usual."""
    draft = any_world(rng, boost)
    most = 3.0 if not draft.setting.plain else 30.0  # the loop lives on what it measures
    factors = [between(rng, 0.1, m) for m in (most, most, 30.0, 30.0)]
    draft.noise_size = draft.noise_size * np.array(factors)
    return draft


def coloured(rng: np.random.Generator, boost: float) -> Draft:
    """Noise with a correlation time of 0.01 to 1 s, at the scale of the simulation."""
    draft = any_world(rng, boost)
    draft.noise = noise.coloured(between(rng, 0.01, 1.0))
    return draft


def half_coloured(rng: np.random.Generator, boost: float) -> Draft:
    """White noise on top of coloured."""
    draft = any_world(rng, boost)
    draft.noise = noise.mixed(between(rng, 0.01, 1.0))
    return draft


def heavy_tails(rng: np.random.Generator, boost: float) -> Draft:
    """Noise with rare large values."""
    draft = any_world(rng, boost)
    draft.noise = noise.heavy
    return draft


def growing_noise(rng: np.random.Generator, boost: float) -> Draft:
    """Noise that grows in time."""
    draft = any_world(rng, boost)
    draft.noise = noise.growing
    return draft


RECIPES: dict[str, Recipe] = {
    "plain_noise": plain_noise,
    "other_sizes": other_sizes,
    "coloured": coloured,
    "half_coloured": half_coloured,
    "heavy_tails": heavy_tails,
    "growing_noise": growing_noise,
}
