"""Forces of no kind are told as the formula that they are, and the patched model reaches the noise."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.missing.curves import CurveFit
from rthm_analysis.diagnosis.missing.features import Curve, Feature
from rthm_analysis.diagnosis.missing.motion import Along
from rthm_analysis.diagnosis.missing.shapes import shapes_over
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.physical.polygon import is_polygon, polygon
from rthm_core.effects.written import Formula

from .plain import plant, recorded


@pytest.mark.parametrize(
    ("law", "formula", "numbers"),
    [
        (lambda t, x, v: 0.05 * math.sin(2.0 * math.pi * x / 0.03), "sin(2 * pi * x / b)", {"b": 0.03}),
        (lambda t, x, v: -0.9 * x if t > 9.0 else 0.0, "x * (b < t)", {"a": -0.9, "b": 9.0}),
        (lambda t, x, v: -1.2 * x * math.sin(2.2 * t), "x * sin(b * t)", {"b": 2.2}),
        pytest.param(lambda t, x, v: -5.0 * x * x * v, "v * x**2", {"a": -5.0}, marks=pytest.mark.long),
        pytest.param(
            lambda t, x, v: -0.2 * math.copysign(abs(v) ** 1.5, v),
            "sign(v) * abs(v)**b",
            {"a": -0.2, "b": 1.5},
            marks=pytest.mark.long,
        ),
    ],
    ids=["cogging", "stiffer since", "swings", "van der Pol", "power"],
)
def test_a_force_of_no_kind_is_told_as_its_formula(law, formula: str, numbers: dict[str, float]) -> None:  # type: ignore[no-untyped-def]
    part = physical_part(diagnose_physical(recorded(law), plant(), np.empty(0), lambda said: None))
    (one,) = part.effects
    assert one["kind"] == "formula" and not part.physics and not part.unexplained
    assert formula in str(one["force"])
    for name, value in numbers.items():
        assert float(one[name]) == pytest.approx(value, rel=0.02)  # type: ignore[arg-type]
    assert part.described[0].formula and "fitted law" in part.described[0].words
    fits = {fit.signal: fit.nrmse for fit in part.fits}
    assert fits["x1"]["explained"] < 1.3 * fits["x1"]["noise_floor"]


@pytest.mark.long
def test_a_force_that_nothing_foretells_is_told_as_that_and_predicts_nothing() -> None:
    rng = np.random.default_rng(3)
    lines, phases = rng.uniform(2.0, 5.0, 40), rng.uniform(0.0, 6.28, 40)
    part = physical_part(
        diagnose_physical(
            recorded(lambda t, x, v: 0.05 * float(np.sin(lines * t + phases).sum())),
            plant(),
            np.empty(0),
            lambda said: None,
        )
    )
    assert not part.physics and not part.effects and part.unexplained
    (one,) = part.described
    assert one.depends_on == ("t",) and one.held_out_gain == 0.0 and one.formula is None
    assert "nobody recorded" in one.words


@pytest.mark.parametrize("variable", ["x", "v", "t", "load"])
def test_every_shape_of_the_grammar_is_a_law(variable: str) -> None:
    at = np.linspace(0.0 if variable == "t" else -0.3, 0.5, 14)
    for text in {shape.text for shape in shapes_over(variable, at)}:
        shape = next(one for one in shapes_over(variable, at) if one.text == text)
        for carrier in ("1", "x", "sign(v)"):
            term = Term("x1", carrier, ((variable, shape),), size=2.0)
            law = Formula.of(term.formula)
            assert set(term.depends_on) == set(law.depends_on)
            assert list(term.numbers) == [name for name in law.parameters if name != "force"]


def test_a_force_that_goes_with_the_square_of_the_known_load_depends_on_it() -> None:
    seen = recorded()
    squared = replace(seen, load=np.sign(seen.load) * np.sqrt(0.6 * np.abs(seen.load)))
    part = physical_part(diagnose_physical(squared, plant(), np.empty(0), lambda said: None))
    assert not part.physics and {one["kind"] for one in part.effects} == {"formula"}
    (one,) = part.described
    assert one.depends_on == ("load",) and min(one.share, one.held_out_gain) > 0.95
    assert all("load" in str(one["force"]) for one in part.effects)
    fits = {fit.signal: fit.nrmse for fit in part.fits}
    assert fits["x1"]["explained"] < 1.3 * fits["x1"]["noise_floor"]


def test_a_free_curve_is_a_law_as_it_stands() -> None:
    knots = np.linspace(-0.2, 0.3, 14)
    feature = Feature(("x",), {"x": np.zeros(1)}, (Curve("1", "x", knots),))
    sizes = np.cumsum(np.random.default_rng(1).normal(size=14))
    at = Along(np.zeros(1), np.zeros(1), np.zeros(1), np.zeros(1))
    guess = polygon(
        CurveFit("x1", feature, sizes, np.ones(14), 1.0, 1.0, 1.0, 1.0, at, np.zeros((1, 0)), np.zeros(0))
    )
    assert guess is not None and is_polygon(str(guess.added.parameters["force"]))
    law = guess.added.law
    numbers = [float(guess.added.parameters[name]) for name in guess.free]
    for place in np.linspace(knots[0], knots[-1], 7):
        force = law.force(place, 0.0, [], 0.0, tuple(numbers), 0)  # type: ignore[attr-defined]
        assert force == pytest.approx(np.interp(place, knots, sizes), abs=1e-4)
