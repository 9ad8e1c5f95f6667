"""The inputs that a planned test may have, coarsest differences first."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain, zip_longest
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.experiment.bounds import Bounds
from rthm_analysis.diagnosis.experiment.response import Response
from rthm_analysis.diagnosis.experiment.trials import SIDES, Trial, constant, harmonic, multisine

if TYPE_CHECKING:
    from rthm_core.spec import Spec

BAND = (0.4, 1.4)
"""Frequencies that are tried, over those of the slowest and the fastest mode."""

BETWEEN = 4
"""Frequencies that are tried between the ends of the band, beside the modes."""

SLOWEST = 3.0
"""Fewest periods of a harmonic load within the test."""

MOST_PERIODS = 30.0
"""Most, where no mode says what is fast."""

LEVELS = (1.0, 0.25)
"""Amplitudes over the largest: friction and play show in small motions, curved springs in large ones."""

RELEASES = (2.0, 1.5, 0.5)
"""Initial motions over that of the present test."""

WAVES = 20
"""Sinusoids of a multisine."""


def candidates(nominal: Spec, bounds: Bounds, duration: float) -> Iterator[Trial]:
    """Trials in an order in which those left out at its end are missed least."""
    response = Response(nominal)
    frequencies = _frequencies(response, duration)
    places = [
        _at(response, bounds, frequencies, side, dof)
        for side in SIDES
        if getattr(nominal, side) is not None
        for dof in getattr(nominal, side).dofs
    ]
    yield from (Trial({}, by) for by in RELEASES if _moves(nominal))
    yield from (one for one in chain.from_iterable(zip_longest(*places)) if one is not None)


def _at(response: Response, bounds: Bounds, frequencies: list[float], side: str, dof: str) -> Iterator[Trial]:
    largest = {w: _largest(response, bounds, side, dof, w) for w in [0.0, *frequencies]}
    for level in LEVELS:
        for frequency in frequencies:
            yield Trial({side: harmonic(dof, level * largest[frequency], frequency)})
    low, high = frequencies[0], frequencies[-1]
    rms = min(largest[w] for w in frequencies)
    yield Trial({side: multisine(dof, rms, low, high, WAVES)})
    yield Trial({side: constant(dof, 0.5 * largest[0.0])})  # what is put on at once swings to twice


def _largest(response: Response, bounds: Bounds, side: str, dof: str, frequency: float) -> float:
    """Largest amplitude of a load, N, that a linear test would bear."""
    sizes = response.sizes(side, dof, frequency)
    borne = [most / sizes[family] for family, most in bounds.signals.items() if sizes.get(family)]
    return min([*borne, *([bounds.load] if bounds.load else [])], default=0.0)


def _frequencies(response: Response, duration: float) -> list[float]:
    """Frequencies of harmonic loads, rad/s, ascending."""
    slowest = 2.0 * np.pi * SLOWEST / duration
    modes = response.modes
    if not modes.size:
        return list(np.geomspace(slowest, MOST_PERIODS / SLOWEST * slowest, BETWEEN + 2))
    spread = np.geomspace(BAND[0] * modes[0], BAND[1] * modes[-1], BETWEEN + 2)
    return sorted({max(float(w), slowest) for w in [*spread, *modes]})


def _moves(nominal: Spec) -> bool:
    """Whether the present test begins with a motion."""
    assert nominal.plant is not None
    return any([*nominal.plant.initial_position, *nominal.plant.initial_velocity])
