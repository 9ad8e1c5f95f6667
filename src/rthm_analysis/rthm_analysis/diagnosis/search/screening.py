"""Score every candidate from one replay each: how much of the squared error it could remove.

A candidate's replay gives the direction in which it moves the prediction. What the directions of the
parameters in play already explain is taken out; the rest, against the residual, gives size and gain.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from rthm_analysis.diagnosis.criteria.search import LARGEST_SIZE_FACTOR
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.compiled import Floats
from rthm_core.errors import InputError


@dataclass(frozen=True)
class ScoredCandidate:
    """A start with its estimated size.

    Attributes
    ----------
    start : InitialGuess
        With the estimated amplitude.
    gain : float
        Part of the squared error that it would remove, in units of the noise.
    std : float
        Standard deviation of the first amplitude, in its unit; inf where there is none.
    shift : (p,) array
        How far the parameters that the model has already should move with it.
    """

    start: InitialGuess
    gain: float
    std: float
    shift: Floats = field(default_factory=lambda: np.empty(0), compare=False)


def screen(
    fitting: Fitting, fitted: Fitted, known: Floats, starts: Iterable[InitialGuess]
) -> list[ScoredCandidate]:
    """Screen candidates that would be added to a fitted model, best first.

    Parameters
    ----------
    fitting : Fitting
    fitted : Fitted
        The model without them.
    known : (p, t k) array
        Its projected columns.
    starts : iterable of InitialGuess
    """
    precision = fitted.sums.precision
    inverse = (
        np.linalg.pinv(known @ known.T + np.diag(precision), hermitian=True)
        if known.size
        else np.zeros((0, 0))
    )
    here = fitting.projected(fitting.residual(fitted.model))

    def cleaned(column: Floats) -> Floats:
        return column - (inverse @ (known @ column)) @ known if known.size else column

    cleared = cleaned(here)

    def one(start: InitialGuess) -> ScoredCandidate | None:
        try:
            model = start.added_to(fitted.model)
            there = fitting.projected(fitting.residual(model))
        except (InputError, np.linalg.LinAlgError):
            return None
        change = here - there
        if not np.isfinite(change).all():
            return None
        if not start.amplitude:
            left = cleaned(there)
            return ScoredCandidate(start, float(cleared @ cleared - left @ left), np.inf)
        rest = cleaned(change)
        size = float(rest @ rest)
        if size <= 1e-12 * float(change @ change) or size <= 0.0:
            return None
        if start.also is not None:
            return two(start, change, rest, cleared)
        factor = float(rest @ cleared) / size
        if factor < 0.0 and not start.signed:
            return ScoredCandidate(start, 0.0, start.trial * size**-0.5)
        limited = min(max(factor, -LARGEST_SIZE_FACTOR), LARGEST_SIZE_FACTOR) or 1e-3
        shift = -limited * (inverse @ (known @ change)) if known.size else np.empty(0)
        return ScoredCandidate(start.sized(limited), factor * factor * size, start.trial * size**-0.5, shift)

    def two(start: InitialGuess, change: Floats, rest: Floats, cleared: Floats) -> ScoredCandidate | None:
        """Sizes of two parameters at once; None where the simulation diverges."""
        model = start.doubled.added_to(fitted.model)
        more = cleaned(here - fitting.projected(fitting.residual(model)) - change)
        if not np.isfinite(more).all():
            return None
        columns = np.stack([rest, more])
        matrix, right = columns @ columns.T, columns @ cleared
        first, second = np.linalg.lstsq(matrix, right, rcond=1e-12)[0]
        std = start.trial * float(np.sqrt(max(np.linalg.pinv(matrix)[0, 0], 0.0)))
        if first <= 0.0:
            return ScoredCandidate(start, 0.0, std)
        limited = min(max(float(first), 1e-3), LARGEST_SIZE_FACTOR)
        gain = float(first * right[0] + second * right[1])
        return ScoredCandidate(start.sized(limited).with_also(1.0 + float(second / first)), gain, std)

    found = [one for one in fitting.cores.each(one, starts) if one is not None]
    return sorted(found, key=lambda s: -s.gain)


def best_of_each(screened: list[ScoredCandidate], most: int, apart: str = "") -> list[ScoredCandidate]:
    """Best `most` starts of each kind at each place, in order; and of each value of the parameter `apart`."""
    count: dict[tuple[object, ...], int] = {}
    kept = []
    for one in screened:
        key = (*one.start.label, one.start.added.parameters.get(apart))
        count[key] = count.get(key, 0) + 1
        if count[key] <= most:
            kept.append(one)
    return kept
