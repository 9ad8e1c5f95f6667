"""Channels that come late or early by a constant time, and how that is told from a sensor's lag."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.faults.spectra import Spectra, spectra

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

COHERENT = 0.9
"""Squared coherence of the frequencies that count."""

FEWEST = 8
"""Frequencies from which a delay is told."""

RELATIVE = 7e-4
"""Relative error of a gain at one frequency that sampling leaves: more is not asked of any model."""

LONGEST = 0.2
"""Largest delay, s."""

CLEARER = 30.0
"""By so much the weighted squares of a delay must be below those of a lag: one in a million by chance."""

REMAINS = 0.25
"""Part of the weighted squares that a delay may leave."""

GOOD = 3.0
"""Weighted squares for each frequency that a delay may leave: with much more, it is something else."""

LEAST_SAMPLES = 1.5
"""A shorter delay is left to others."""


@dataclass(frozen=True)
class Late:
    """A constant delay of one signal after another, s, with its standard deviation."""

    delay: float
    std: float


def late(reference: Floats, signal: Floats, step: float, *, rate: bool = False) -> Late | None:
    """Delay of `signal` after `reference`, both (s,), of any gain; None where there is none, or it is a lag.

    With `rate` the reference is a position, and the signal is compared with its rate. A delay turns phases in proportion to the frequency and leaves amplitudes; a first-order lag, of the one
    or of the other, loses amplitude with the frequency.
    """
    known = np.gradient(reference, step) if rate else reference
    seen = spectra(np.column_stack([known, signal]), step)
    kept = seen.coherence(0, 1) > COHERENT
    if np.count_nonzero(kept) < FEWEST:
        return None
    return _late(_only(seen, kept), step, rate)


def _only(seen: Spectra, kept: np.ndarray) -> Spectra:
    return Spectra(seen.omega[kept], seen.cross[kept], seen.parts)


def _late(seen: Spectra, step: float, rate: bool) -> Late | None:
    omega, coherence = seen.omega, seen.coherence(0, 1)
    response = seen.cross[:, 0, 1] / seen.cross[:, 0, 0].real
    if rate:  # what differences of samples lose
        response = response * np.sin(omega * step) / (omega * step)
    sampling = RELATIVE + np.square(omega * step) / 8.0  # the latter is what straight lines between samples lose
    share = 0.5 * (1.0 - coherence) / (coherence * seen.parts) + (1.0 - coherence) ** 2 + np.square(sampling)
    weight = 1.0 / (share * np.abs(response) ** 2)
    delays = np.arange(-LONGEST, LONGEST, 0.25 * step)
    costs = _costs(response, weight, np.exp(-1j * np.outer(delays, omega)))
    best = int(np.argmin(costs))
    lags = np.geomspace(0.2 * step, 2.0 * LONGEST, 60)
    shapes = 1.0 / (1.0 + 1j * np.outer(lags, omega))
    as_lag = min(_costs(response, weight, shapes).min(), _costs(response, weight, 1.0 / shapes).min())
    none = float(_costs(response, weight, np.ones((1, omega.size)))[0])
    curvature = float(np.sum(weight * np.abs(response) ** 2 * np.square(omega)))
    delay, std = float(delays[best]), float(np.sqrt(1.0 / max(curvature, 1e-300)))
    fits = costs[best] < min(REMAINS * none, GOOD * omega.size)
    clear = fits and costs[best] + CLEARER < as_lag
    inside = 0 < best < delays.size - 1
    return Late(delay, std) if clear and inside and abs(delay) > LEAST_SAMPLES * step else None


def _costs(response: np.ndarray, weight: Floats, shapes: np.ndarray) -> Floats:
    """Weighted squares that each shape (g, f) leaves of a response (f,), at its best real gain."""
    along = np.real(shapes.conj() * response) @ weight
    size = np.square(np.abs(shapes)) @ weight
    total = float(np.square(np.abs(response)) @ weight)
    return np.asarray(total - np.square(along) / size)
