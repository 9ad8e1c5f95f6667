"""Frequency responses of every set, computed once for Figs. 11 and 13 and Table III."""

from __future__ import annotations

from functools import cache

import numpy as np

from rthm_analysis.reproduce.candidates import ALL, Candidate, loop
from rthm_analysis.response import Response, response
from rthm_core.compiled import Floats

LOWEST, HIGHEST, POINTS = 0.5, 10.0, 241
MARKED = (1.0, 2.4)
"""Frequencies of Table III and Fig. 12, rad/s."""


@cache
def grid() -> Floats:
    """Frequencies of the plots, rad/s; the marked ones are among them."""
    return np.unique(np.concatenate([np.geomspace(LOWEST, HIGHEST, POINTS), MARKED]))


@cache
def responses() -> dict[Candidate, Response]:
    """Response of every set."""
    return {one: response(loop(one), grid()) for one in ALL}


def unwrapped(phase: Floats) -> Floats:
    """Phase (W,) in degrees without jumps, from an angle in radians."""
    return np.degrees(np.unwrap(phase))
