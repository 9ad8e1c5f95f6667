"""The error of a motor is a curve over its position, or a line over time, on samples that did not make it."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_analysis.diagnosis.criteria.missing import FORETOLD_SHARE
from rthm_analysis.diagnosis.physical.motor_curves import _line, _over, _share

TIME = np.arange(8000) * 0.005
U = 0.1 * np.sin(1.3 * TIME) + 0.07 * np.sin(2.9 * TIME + 0.4)
FIRST = np.arange(TIME.size) < 4800
NOISE = 1e-5


@pytest.mark.parametrize(
    ("error", "over"),
    [
        (3e-4 * np.sin(2.0 * np.pi * U / 0.04), "u"),
        (2e-5 * TIME, "t"),
        (3e-4 * np.sin(np.cumsum(np.random.default_rng(1).normal(size=TIME.size))), ""),
    ],
    ids=["screw", "creeps", "neither"],
)
def test_what_explains_an_error_is_told_by_samples_that_did_not_make_it(error: np.ndarray, over: str) -> None:
    read = error + np.random.default_rng(0).normal(0.0, NOISE, error.size)
    curves = {"u": _over(U, read, FIRST), "t": _line(TIME, read, FIRST)}
    shares = {one: _share(read / NOISE, curve / NOISE, ~FIRST) for one, curve in curves.items()}
    best = max(shares, key=lambda one: shares[one])
    assert (best == over and shares[best] > 0.97) if over else shares[best] < FORETOLD_SHARE
