"""A mass that changes is told as that, with how much of it."""

from __future__ import annotations

import re

import pytest

from rthm_analysis.diagnosis.missing.curves import CurveFit, free_curves
from rthm_analysis.diagnosis.missing.describe import described, told
from rthm_analysis.diagnosis.missing.formulas import shown_by
from rthm_analysis.diagnosis.replay.evidence import Evidence

from .plain import MASS, left_of, recorded


def _told(seen: Evidence) -> CurveFit | None:
    return told(free_curves(left_of(seen, train=seen.trained)))


@pytest.mark.parametrize(
    ("mass", "last"),
    [(lambda t: MASS * (1.0 + 0.004 * t), 0.115), (lambda t: MASS + (0.06 if t > 8.0 else 0.0), 0.06)],
    ids=["drifts", "steps"],
)
def test_a_mass_that_changes_is_told_with_its_change(mass, last: float) -> None:  # type: ignore[no-untyped-def]
    one = _told(recorded(mass=mass))
    assert one is not None and one.feature.depends_on == ("a", "t") and one.held_out_share > 0.95
    assert not shown_by(one)
    found = described(one, None, beside=False)
    assert "acceleration of x1 and time" in found.words and found.formula is None
    first, end = map(float, re.findall(r"(\S+) kg", found.words))
    assert first == pytest.approx(0.0, abs=0.012) and end == pytest.approx(last, rel=0.15)
    assert set(found.domain) == {"a"}


def test_a_stiffness_that_changes_is_no_mass() -> None:
    one = _told(recorded(lambda t, x, v: -0.05 * t * x))
    assert one is not None and not one.feature.of_mass and one.feature.depends_on == ("x", "t")
