"""Noise that is not white; every function returns (n, 4) deviates of size 1."""

from __future__ import annotations

import numpy as np
from benchmarks.concealed.open.draft import Noise


def coloured(time_constant: float) -> Noise:
    """First-order noise with this correlation time, s."""

    def noise(rng: np.random.Generator, n: int, period: float) -> np.ndarray:
        keep = float(np.exp(-period / time_constant))
        fresh = np.sqrt(1.0 - keep**2) * rng.normal(size=(n, 4))
        out = np.empty((n, 4))
        out[0] = rng.normal(size=4)
        for i in range(1, n):
            out[i] = keep * out[i - 1] + fresh[i]
        return out

    return noise


def heavy(rng: np.random.Generator, n: int, period: float) -> np.ndarray:
    """Student's t with three degrees of freedom."""
    return rng.standard_t(3, size=(n, 4)) / np.sqrt(3.0)


def growing(rng: np.random.Generator, n: int, period: float) -> np.ndarray:
    """White noise that grows from a third to twice its size."""
    return rng.normal(size=(n, 4)) * np.linspace(0.33, 2.0, n)[:, None]


def mixed(time_constant: float) -> Noise:
    """White and coloured noise of equal size."""

    def noise(rng: np.random.Generator, n: int, period: float) -> np.ndarray:
        slow = coloured(time_constant)(rng, n, period)
        return (rng.normal(size=(n, 4)) + slow) / np.sqrt(2.0)

    return noise
