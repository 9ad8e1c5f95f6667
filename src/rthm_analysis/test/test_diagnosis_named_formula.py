"""A formula whose terms are laws of the library is told by their names, and no other is."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_analysis.diagnosis.missing.motion import Along
from rthm_analysis.diagnosis.physical.named_laws import kind_as
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.search.starts import InitialGuess

from .faulty import PLAIN

TIME = np.linspace(0.0, 20.0, 2000)
MOTION = Along(0.1 * np.sin(2.0 * TIME), 0.2 * np.cos(2.0 * TIME), TIME, np.zeros(TIME.size))


def named(formula: str, **numbers: float) -> InitialGuess | None:
    term = EffectInstance("plant", "formula", "x1", {"force": formula, **numbers})
    start = InitialGuess(term, tuple(numbers), ("a",), dict.fromkeys(numbers, 1.0))
    return kind_as(start.added_to(Model(PLAIN, ())), 0, MOTION)


@pytest.mark.parametrize(
    ("formula", "size", "kind", "number"),
    [
        ("a * sign(v)", -0.1, "coulomb_friction", 0.1),
        ("a * x**3", -20.0, "cubic_stiffness", 20.0),
        ("a * x**3", 20.0, "cubic_stiffness", -20.0),
        ("a * v * abs(v)", -0.3, "quadratic_drag", 0.3),
    ],
)
def test_a_term_has_the_name_of_its_law(formula: str, size: float, kind: str, number: float) -> None:
    one = named(formula, a=size)
    assert one is not None and one.added.kind == kind
    assert next(iter(one.added.parameters.values())) == pytest.approx(number, rel=1e-9)


def test_a_sine_in_small_motions_is_a_cubic_spring() -> None:
    one = named("a * (x - sin(x))", a=-12.0)
    assert one is not None and one.added.kind == "cubic_stiffness"
    assert one.added.parameters["coefficient"] == pytest.approx(2.0, rel=1e-3)


@pytest.mark.parametrize(
    ("formula", "numbers"),
    [
        ("a * v * abs(v)", {"a": 0.3}),  # a drag that drives is none
        ("a * tanh(v / b)", {"a": -0.1, "b": 1e-3}),
        ("a * x**5", {"a": -20.0}),
    ],
)
def test_what_is_no_law_of_the_library_keeps_its_formula(formula: str, numbers: dict[str, float]) -> None:
    assert named(formula, **numbers) is None
