"""A mass that changes is told as that, with how much of it."""

from __future__ import annotations

import re

import numpy as np
import pytest

from rthm_analysis.diagnosis.missing.curves import CurveFit, free_curves
from rthm_analysis.diagnosis.missing.describe import described, plainest, told
from rthm_analysis.diagnosis.missing.formulas import shown_by
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.physical.side import diagnose_physical
from rthm_analysis.diagnosis.replay.evidence import Evidence

from .plain import MASS, left_of, plant, recorded


def _told(seen: Evidence) -> CurveFit | None:
    return told(free_curves(left_of(seen, train=seen.trained)))


@pytest.mark.parametrize(
    ("mass", "last"),
    [(lambda t, x: MASS * (1.0 + 0.004 * t), 0.115), (lambda t, x: MASS + (0.06 if t > 8.0 else 0.0), 0.06)],
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


def test_a_mass_that_is_another_throughout_does_not_change() -> None:
    one = _told(recorded(mass=lambda t, x: 1.05 * MASS))
    assert one is None or not one.feature.of_mass


def test_a_mass_that_changes_at_once_is_told_by_no_curve_but_lets_its_kind_be_tried() -> None:
    seen = recorded(mass=lambda t, x: MASS + (0.06 if t > 0.3 else 0.0))
    curves = free_curves(left_of(seen, train=seen.trained))
    shown, one = plainest(curves), told(curves)
    assert shown is not None and shown.feature.of_mass
    assert one is None or not one.feature.of_mass


def test_a_stiffness_that_changes_is_no_mass() -> None:
    one = _told(recorded(lambda t, x, v: -0.05 * t * x))
    assert one is not None and not one.feature.of_mass and one.feature.depends_on == ("x", "t")


@pytest.mark.long
@pytest.mark.parametrize(
    ("mass", "kind", "truth"),
    [
        (
            lambda t, x: MASS - (0.2 if t > 4.321 else 0.0),
            "mass_change",
            {"change": -0.2, "at": 4.321},
        ),
        (
            lambda t, x: MASS + 0.02 * max(t - 3.0, 0.0),
            "growing_mass",
            {"rate": 0.02, "at": 3.0},
        ),
        (
            lambda t, x: MASS + 0.15 * min(max(t - 4.0, 0.0) / 3.0, 1.0),
            "mass_change",
            {"change": 0.15, "at": 4.0, "within": 3.0},
        ),
        (
            lambda t, x: MASS + (0.06 if t > 0.712 else 0.0),
            "mass_change",
            {"change": 0.06, "at": 0.712},
        ),
    ],
    ids=["drops off", "is scooped", "joins slowly", "joins early"],
)
def test_a_mass_that_changes_is_an_effect_of_the_patched_spec(mass, kind: str, truth) -> None:  # type: ignore[no-untyped-def]
    seen = recorded(mass=mass, duration=15.0)
    part = physical_part(diagnose_physical(seen, plant(), np.empty(0), lambda said: None))
    (one,) = part.physics
    assert one.kind == kind and not (part.unexplained or part.described)
    for name, value in truth.items():
        found = one.parameters[name]
        assert abs(found.value - value) < max(5.0 * found.std, 0.01 * abs(value))
        assert found.std < 0.01 * abs(value)
    (section,) = part.effects
    assert section["kind"] == kind and section["dof"] == "x1"
