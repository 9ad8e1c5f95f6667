"""Of a long recording only one of some samples is asked where hundreds of columns are needed at once."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_analysis.diagnosis.fitting import fitting
from rthm_analysis.diagnosis.missing import curves
from rthm_analysis.diagnosis.missing.curves import CurveFit, free_curves

from .plain import left_of, recorded

TRAIN = 3200


@pytest.fixture(scope="module")
def each() -> list[CurveFit]:
    return free_curves(left_of(SEEN, train=TRAIN))


SEEN = recorded(lambda t, x, v: -0.02 * np.tanh(200.0 * v))


def test_a_free_curve_of_some_samples_is_that_of_all(
    each: list[CurveFit], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(curves, "REGRESSION_SAMPLES", 1500)
    left = left_of(SEEN, train=TRAIN)
    assert left.fitting.measured.shape[0] == 1601
    a, b = _over_velocity(free_curves(left)), _over_velocity(each)
    assert 3.0 * a.gain == pytest.approx(b.gain, rel=0.1)
    assert a.share == pytest.approx(b.share, abs=0.02)
    assert a.held_out_share == pytest.approx(b.held_out_share, abs=0.02)
    assert np.allclose(a.sizes, b.sizes, atol=0.1 * np.abs(b.sizes).max())


def _over_velocity(found: list[CurveFit]) -> CurveFit:
    return next(one for one in found if one.feature.depends_on == ("v",))


def test_samples_are_no_further_apart_than_a_small_part_of_a_period(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(curves, "REGRESSION_SAMPLES", 10)
    left = left_of(SEEN)
    assert 200 < left.fitting.measured.shape[0] < 1000
    monkeypatch.setattr(fitting, "COLUMN_SAMPLES", 100)
    thinner = left_of(SEEN)
    assert thinner.left.size < 2 * 100 * 2
    assert sum(block.stop - block.start for block in thinner.train) == thinner.left.size


def test_fits_of_a_short_recording_have_all_samples(each: list[CurveFit]) -> None:
    assert each[0].at.t.size == SEEN.time.size
    assert left_of(SEEN).left.size == SEEN.measured.size
