"""The inputs that a planned test may have, coarsest differences first."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain, zip_longest
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.experiment import (
    HARMONIC_FEWEST_PERIODS,
    HARMONIC_MOST_PERIODS,
    MULTISINE_WAVES,
    TRIED_AMPLITUDES,
    TRIED_BAND,
    TRIED_BETWEEN,
    TRIED_RELEASES,
)
from rthm_analysis.diagnosis.experiment.bounds import Bounds
from rthm_analysis.diagnosis.experiment.response import Response
from rthm_analysis.diagnosis.experiment.trials import SIDES, Trial, constant, harmonic, multisine

if TYPE_CHECKING:
    from rthm_core.spec import Spec


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
    yield from (Trial({}, by) for by in TRIED_RELEASES if _moves(nominal))
    yield from (one for one in chain.from_iterable(zip_longest(*places)) if one is not None)


def _at(response: Response, bounds: Bounds, frequencies: list[float], side: str, dof: str) -> Iterator[Trial]:
    largest = {w: _largest(response, bounds, side, dof, w) for w in [0.0, *frequencies]}
    for level in TRIED_AMPLITUDES:
        for frequency in frequencies:
            yield Trial({side: harmonic(dof, level * largest[frequency], frequency)})
    low, high = frequencies[0], frequencies[-1]
    rms = min(largest[w] for w in frequencies)
    yield Trial({side: multisine(dof, rms, low, high, MULTISINE_WAVES)})
    yield Trial({side: constant(dof, 0.5 * largest[0.0])})  # what is put on at once swings to twice


def _largest(response: Response, bounds: Bounds, side: str, dof: str, frequency: float) -> float:
    """Largest amplitude of a load, N, that a linear test would bear."""
    sizes = response.sizes(side, dof, frequency)
    borne = [most / sizes[family] for family, most in bounds.signals.items() if sizes.get(family)]
    return min([*borne, *([bounds.load] if bounds.load else [])], default=0.0)


def _frequencies(response: Response, duration: float) -> list[float]:
    """Frequencies of harmonic loads, rad/s, ascending."""
    slowest = 2.0 * np.pi * HARMONIC_FEWEST_PERIODS / duration
    modes = response.modes
    if not modes.size:
        return list(
            np.geomspace(
                slowest, HARMONIC_MOST_PERIODS / HARMONIC_FEWEST_PERIODS * slowest, TRIED_BETWEEN + 2
            )
        )
    spread = np.geomspace(TRIED_BAND[0] * modes[0], TRIED_BAND[1] * modes[-1], TRIED_BETWEEN + 2)
    return sorted({max(float(w), slowest) for w in [*spread, *modes]})


def _moves(nominal: Spec) -> bool:
    """Whether the present test begins with a motion."""
    assert nominal.plant is not None
    return any([*nominal.plant.initial_position, *nominal.plant.initial_velocity])
