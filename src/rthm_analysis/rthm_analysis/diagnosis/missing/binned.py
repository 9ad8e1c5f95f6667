"""Averages of a force over another variable."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import CURVE_BINS, CURVE_SAMPLES_SHOWN
from rthm_core.compiled import Floats


def spread_over(values: Floats, force: Floats) -> tuple[Floats, Floats]:
    """Samples of `values` (s,) and `force` (s,) spread evenly over the values, few enough to show."""
    order = np.argsort(values, kind="stable")
    wanted = np.linspace(values[order[0]], values[order[-1]], CURVE_SAMPLES_SHOWN)
    rows = order[np.unique(np.searchsorted(values[order], wanted))]
    return values[rows], force[rows]


def binned(
    values: Floats, force: Floats, edges: Floats | None = None
) -> tuple[Floats, Floats, Floats, float]:
    """Average `force` (s,) in bins of `values` (s,) between some edges, or that hold as many samples each.

    Returns
    -------
    at, mean, std : (b,) arrays
        Mean abscissa and force of each bin, and the standard deviation of that mean.
    share : float
        Part of the variance of the force that the means explain.
    """
    if edges is None:
        edges = np.quantile(values, np.linspace(0.0, 1.0, CURVE_BINS + 1))
    bins = edges.size - 1
    number = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, bins - 1)
    count = np.maximum(np.bincount(number, minlength=bins), 1)
    at = np.bincount(number, values, bins) / count
    mean = np.bincount(number, force, bins) / count
    spread = np.sqrt(np.maximum(np.bincount(number, force**2, bins) / count - mean**2, 0.0) / count)
    share = float(np.var(mean[number]) / max(float(np.var(force)), 1e-300))
    used = np.bincount(number, minlength=bins) > 0
    return at[used], mean[used], spread[used], share
