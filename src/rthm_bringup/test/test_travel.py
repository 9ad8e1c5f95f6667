"""How far motors may go to measure a rig."""

from __future__ import annotations

from pathlib import Path

import pytest

from rthm_bringup.driver.travel import SHARE_OF_LIMITS, check_travel, reaches, safe_travel
from rthm_core.errors import InputError
from rthm_core.spec import apply, spec_at

RIG = spec_at(Path(__file__).parents[3] / "examples" / "rig.yaml")


def test_a_safe_motion_uses_a_quarter_of_the_tightest_limit() -> None:
    travel = safe_travel(RIG, 3.0)
    shares = {one.limit: one.moved / (one.allowed - one.at_rest) for one in reaches(RIG, travel, 3.0)}
    assert max(shares.values()) == pytest.approx(SHARE_OF_LIMITS, rel=0.01)
    assert {"command", "rate", "force", "position", "measured_force"} <= set(shares)
    check_travel(RIG, travel, 3.0)


@pytest.mark.parametrize("limit", ["command", "rate", "force", "position", "velocity", "following"])
def test_any_limit_makes_the_motion_smaller(limit: str) -> None:
    travel = safe_travel(RIG, 2.0)
    reach = {one.limit: one.moved for one in reaches(apply(RIG, {f"limits.{limit}": 1.0}), travel, 2.0)}
    tight = apply(RIG, {f"limits.{limit}": 0.1 * reach[limit]})
    assert safe_travel(tight, 2.0) < 0.2 * travel
    with pytest.raises(InputError, match=rf"limits\.{limit} allows"):
        check_travel(tight, travel, 2.0)
