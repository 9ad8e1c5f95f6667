"""A damping below zero: a rig that something drives, such as a flow."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.result import Retuned
from rthm_analysis.diagnosis.words import retuned_words

from .known_load import DAMPING, SPEC, recorded


def galloping(t: float, x: float, v: float) -> float:
    """A flow that feeds small motions."""
    return 2.0 * DAMPING * v - 8.0 * v**3


@pytest.mark.long
def test_what_a_flow_feeds_has_a_damping_below_zero() -> None:
    physical = diagnose_physical(recorded(galloping), SPEC, np.empty(0), lambda said: None)
    found = physical_part(physical)
    assert found.retuned["plant.damping"].value == pytest.approx(-DAMPING, rel=0.05)
    (force,) = found.described
    assert force.depends_on == ("v",) and force.formula is not None and "v**3" in force.formula


@pytest.mark.parametrize(
    ("key", "words"),
    [("plant.damping", "something feeds energy in"), ("plant.stiffness", "it pushes away from the middle")],
)
def test_what_is_below_zero_is_said_to_be(key: str, words: str) -> None:
    assert words in retuned_words({key: Retuned(2.0, -1.0, 0.01, "")})
    assert "below zero" not in retuned_words({key: Retuned(2.0, -1.0, 0.5, "")})
    assert "below zero" not in retuned_words({key: Retuned(2.0, 1.0, 0.01, "")})
