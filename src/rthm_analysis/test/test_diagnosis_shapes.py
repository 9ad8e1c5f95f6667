"""Shapes that a term is told by: fine pitches, bells, poles, products; and which curves are asked."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from rthm_analysis.diagnosis.criteria.missing import SWING_PEAKS
from rthm_analysis.diagnosis.missing.curves import Regression, free_curves
from rthm_analysis.diagnosis.missing.features import features
from rthm_analysis.diagnosis.missing.formulas import composed
from rthm_analysis.diagnosis.missing.likely import likely
from rthm_analysis.diagnosis.missing.recurring import recurring
from rthm_analysis.diagnosis.replay.experiment import Experiment

from .plain import from_rest, left_of, plant, recorded

Law = Callable[[float, float, float], float]


def _regression(law: Law, force: float = 0.6, duration: float = 24.0) -> Regression:
    return left_of(recorded(law, duration, force=force))


def test_a_pitch_finer_than_any_curve_is_seen_in_the_residual_force() -> None:
    regression = _regression(lambda t, x, v: 0.02 * math.sin(2.0 * math.pi * x / 0.009 + 0.5))
    at = regression.along(0)
    finest = next(one for one in list(features(at))[1].curves).knots
    assert 2.0 * np.diff(finest).max() > 0.009
    best = max(recurring(regression), key=lambda one: one.gain)
    assert best.within[0] == pytest.approx(0.009, rel=0.01)
    (term,) = composed(regression, free_curves(regression), most=1)
    assert term.factors.startswith("sin(2 * pi * x / b + c)")
    assert term.within[:2] == pytest.approx((0.009, 0.5), abs=0.1)


def test_noise_recurs_at_no_pitch() -> None:
    assert all(one.gain < 30.0 for one in recurring(_regression(lambda t, x, v: 0.0)))


def test_samples_that_are_too_few_for_a_pitch_show_less_than_usual() -> None:
    found = list(recurring(_regression(lambda t, x, v: 0.0, duration=0.33)))
    assert len(found) < SWING_PEAKS and all(np.isfinite(one.within).all() for one in found)


@pytest.mark.parametrize(
    ("law", "force", "factors", "numbers"),
    [
        (
            lambda t, x, v: 0.3 * math.exp(-(((x - 0.06) / 0.02) ** 2)),
            0.6,
            "exp(-((x - b) / c)**2)",
            (0.06, 0.02),
        ),
        (lambda t, x, v: 0.003 / (0.3 - x) ** 2, 0.6, "1 / (x - b)**2", (0.3,)),
        (
            lambda t, x, v: -1.5 * max(x - 0.05, 0.0) if t > 9.0 else 0.0,
            1.5,
            "max(x - b, 0) * (c < t)",
            (0.05, 9.0),
        ),
    ],
    ids=["bell", "pole", "from a place and an instant on"],
)
def test_a_shape_is_found_by_its_form(
    law: Law, force: float, factors: str, numbers: tuple[float, ...]
) -> None:
    regression = _regression(law, force)
    (term,) = composed(regression, free_curves(regression), most=1, plain=False)
    assert term.factors == factors
    assert term.within == pytest.approx(numbers, rel=0.1)


def test_a_pole_is_divided_by() -> None:
    regression = _regression(lambda t, x, v: 0.003 / (0.3 - x) ** 2)
    (term,) = composed(regression, free_curves(regression), most=1, plain=False)
    assert term.formula == "a / (x - b)**2"


def test_behind_a_straight_line_over_time_the_curve_is_asked() -> None:
    seen = recorded(lambda t, x, v: -0.02 * t * x)
    asked = likely(Experiment(seen, np.empty(0)), from_rest(), plant())["x1"]
    every = list(features(_regression(lambda t, x, v: 0.0).along(0)))
    straight = {every[i].depends_on for i in asked if every[i].straight}
    shown = {every[i].depends_on for i in asked if not every[i].straight}
    assert ("x", "t") in straight and straight <= shown
