"""What is told of rigs that no kind of the library fits exactly: neither too much, nor something else."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.result import Part

from .known_load import DAMPING, SPEC, STIFFNESS, Force, recorded

LATE = 15.0


def told(force: Force) -> Part:
    return physical_part(diagnose_physical(recorded(force), SPEC, np.empty(0), lambda said: None))


def loosened(t: float, x: float, v: float) -> float:
    """A bolt that comes loose: less stiffness and more damping from then on."""
    return 0.1 * STIFFNESS * x - DAMPING * v if t > LATE else 0.0


class Slipping:
    """A chain of springs that slip one after the other (Iwan)."""

    def __init__(self) -> None:
        self.reach = np.linspace(0.002, 0.02, 8)
        self.at = np.zeros(8)

    def __call__(self, t: float, x: float, v: float) -> float:
        self.at = np.clip(self.at, x - self.reach, x + self.reach)
        return float(-0.05 * STIFFNESS * np.sum(x - self.at))


@pytest.mark.long
def test_a_formula_has_the_terms_that_it_needs() -> None:
    (force,) = told(loosened).described
    assert force.formula is not None and force.formula.count(" < t)") == 2, force.formula
    assert force.formula.count("max(") == 0
    assert force.interval is not None and abs(force.interval[0] - LATE) < 0.5


@pytest.mark.long
def test_what_slips_link_by_link_is_a_hysteretic_spring() -> None:
    """No force of motion alone comes near it, and a law with a memory does."""
    found = told(Slipping())
    assert [one.kind for one in found.physics] == ["bouc_wen"]
    assert found.retuned["plant.stiffness"].value == pytest.approx(STIFFNESS, rel=0.01)
