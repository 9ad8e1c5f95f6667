"""Fewer points for the eye: the extremes of each short span of time, so that no peak is lost."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from rthm_core.compiled import Floats, Integers

SPANS = 1500
"""Spans into which a curve is cut; each gives at most two points."""


def extremes(values: Floats, spans: int = SPANS) -> Integers:
    """Rows of the extremes of a curve (n,) in each span, ends included; all rows of a short one."""
    n = values.size
    if n <= 2 * spans:
        return np.arange(n)
    edges = np.linspace(0, n, spans + 1).astype(np.int64)
    filled = np.where(np.isfinite(values), values, np.nanmean(values) if np.isfinite(values).any() else 0.0)
    rows = [first + part for first, last in pairwise(edges) for part in _two(filled[first:last])]
    return np.unique([0, *rows, n - 1])


def _two(values: Floats) -> tuple[int, int]:
    return int(values.argmin()), int(values.argmax())
