"""Averages of a force over another variable."""

from __future__ import annotations

import numpy as np

from rthm_core.compiled import Floats

BINS = 40


SHOWN = 600
"""Samples that show a law."""


def spread_over(values: Floats, force: Floats) -> tuple[Floats, Floats]:
    """Samples of `values` (s,) and `force` (s,) that are spread evenly over the values: at most `SHOWN`."""
    order = np.argsort(values, kind="stable")
    wanted = np.linspace(values[order[0]], values[order[-1]], SHOWN)
    rows = order[np.unique(np.searchsorted(values[order], wanted))]
    return values[rows], force[rows]


def binned(values: Floats, force: Floats) -> tuple[Floats, Floats, Floats, float]:
    """Average `force` (s,) in bins of `values` (s,) that hold as many samples each.

    Returns
    -------
    at, mean, std : (b,) arrays
        Mean abscissa and force of each bin, and the standard deviation of that mean.
    share : float
        Part of the variance of the force that the means explain.
    """
    edges = np.quantile(values, np.linspace(0.0, 1.0, BINS + 1))
    number = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, BINS - 1)
    count = np.maximum(np.bincount(number, minlength=BINS), 1)
    at = np.bincount(number, values, BINS) / count
    mean = np.bincount(number, force, BINS) / count
    spread = np.sqrt(np.maximum(np.bincount(number, force**2, BINS) / count - mean**2, 0.0) / count)
    share = float(np.var(mean[number]) / max(float(np.var(force)), 1e-300))
    used = np.bincount(number, minlength=BINS) > 0
    return at[used], mean[used], spread[used], share
