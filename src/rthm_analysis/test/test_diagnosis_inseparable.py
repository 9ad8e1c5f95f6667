"""Effects that no recording of a motion tells apart are said to be so."""

from __future__ import annotations

import pytest

from rthm_analysis.diagnosis.physical.inseparable import inseparable
from rthm_analysis.diagnosis.result import Physics, Value


def _found(kind: str, place: str = "x1", **sizes: float) -> Physics:
    return Physics("plant", kind, place, {k: Value(v, 0.1, "N") for k, v in sizes.items()}, "", 0.0, 1.0)


def test_an_offset_beside_dry_friction_may_be_friction_that_differs_with_the_direction() -> None:
    (said,) = inseparable([_found("constant_load", force=2.0), _found("coulomb_friction", force=20.0)])
    assert "friction of 18 N towards +x and 22 N towards -x" in said


@pytest.mark.parametrize(
    "others",
    [
        [_found("constant_load", force=2.0)],
        [_found("coulomb_friction", force=20.0)],
        [_found("constant_load", "x2", force=2.0), _found("coulomb_friction", force=20.0)],
        [_found("quadratic_drag", coefficient=2.0), _found("coulomb_friction", force=20.0)],
    ],
)
def test_what_a_motion_tells_apart_has_no_such_note(others: list[Physics]) -> None:
    assert not list(inseparable(others))
