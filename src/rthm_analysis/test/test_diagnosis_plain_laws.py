"""Plain laws that are found together, in runs and along motions of any law."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.fitting.fitting import Fitting
from rthm_analysis.diagnosis.fitting.noise import white_noise
from rthm_analysis.diagnosis.missing.curves import Regression, free_curves
from rthm_analysis.diagnosis.missing.formulas import composed, fitted_together
from rthm_analysis.diagnosis.missing.plain import plain_laws, plain_sets
from rthm_analysis.diagnosis.physical.beginning import with_unsure
from rthm_analysis.diagnosis.physical.formula_model import guess_of, with_all
from rthm_analysis.diagnosis.physical.named_laws import guesses_of, without_repeated
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_analysis.diagnosis.search.starts import InitialGuess

from .plain import NOISE, left_of, plant, recorded


def _regression(law: Callable[[float, float, float], float], scale: float = 1.0) -> Regression:
    seen = recorded(law, force=6.0 * scale, noise=lambda rng, count: scale * rng.normal(size=(count, 2)))
    return left_of(seen, scale)


@pytest.mark.parametrize(
    ("law", "texts", "kinds"),
    [
        (lambda t, x, v: -0.8 * v * abs(v) - 3.0 * x**3, {"v * abs(v)", "x**3"}, 2),
        (lambda t, x, v: abs(x) - 0.1 * np.sign(v), {"abs(x)", "sign(v)"}, 1),
    ],
)
def test_laws_that_act_together_are_found_together(
    law: Callable[[float, float, float], float], texts: set[str], kinds: int
) -> None:
    regression = _regression(law)
    sets = plain_sets(regression)
    found = sets[-1]
    assert {one.factors for one in found} == texts
    assert [len(one) for one in sets] == list(range(1, len(texts) + 1))
    model, terms = fitted_together(regression, found)
    guesses = guesses_of(regression, model, terms)
    assert sum(not one.added.law.written for one in guesses) == kinds
    assert all(one.added.law.written for one in guesses[kinds:])


def test_a_law_of_tiny_motions_is_found_as_well() -> None:
    regression = _regression(lambda t, x, v: -9.0e24 * x**5, scale=1e-6)
    ((term,),) = plain_sets(regression)
    assert term.factors == "x**5"
    _, (fitted,) = fitted_together(regression, (term,))
    assert fitted.size == pytest.approx(-9.0e24, rel=0.02)


@pytest.mark.parametrize(
    ("law", "factors"),
    [
        (lambda t, x, v: -0.1 * v**3, "v**3"),
        (lambda t, x, v: -0.4 * np.sign(v) * max(abs(v) - 0.5, 0.0), "sign(v) * max(abs(v) - b, 0)"),
    ],
)
def test_a_law_has_no_more_numbers_than_it_needs(
    law: Callable[[float, float, float], float], factors: str
) -> None:
    regression = _regression(law)
    over_v = [one for one in free_curves(regression) if one.feature.depends_on == ("v",)]
    first, *_ = composed(regression, over_v, plain=False)
    plainer, *_ = composed(regression, over_v)
    assert plainer.factors == factors and len(plainer.within) <= len(first.within)


def test_noise_is_no_law() -> None:
    assert not plain_sets(_regression(lambda t, x, v: 0.0))


def test_a_law_that_a_model_has_is_no_term_beside_it() -> None:
    regression = _regression(lambda t, x, v: 0.0)
    terms = plain_laws("x1", regression.along(0))
    drag = EffectInstance("plant", "quadratic_drag", "x1", {"coefficient": 2.0})
    model = InitialGuess(drag, ("coefficient",), ("coefficient",)).added_to(regression.model)
    assert [one.factors for one in terms if one not in without_repeated(regression, model, terms)] == [
        "v * abs(v)"
    ]
    assert without_repeated(regression, regression.model, terms) == tuple(terms)


def test_laws_that_are_one_along_a_recording_are_asked_once() -> None:
    at = _regression(lambda t, x, v: 0.0).along(0)
    laws = {one.factors for one in plain_laws("x1", at)}
    one_way = {one.factors for one in plain_laws("x1", at._replace(x=np.abs(at.x) + 1e-3))}
    assert {"x * abs(x)", "abs(x)", "x**2"} <= laws
    assert "abs(x)" not in one_way and len({"x * abs(x)", "x**2"} & one_way) == 1


@np.errstate(over="ignore", invalid="ignore")
def test_a_fit_never_ends_farther_from_a_recording_than_it_began() -> None:
    seen = recorded(lambda t, x, v: 12.0 * (x - np.sin(x)), start=2.2, force=0.0, duration=60.0)
    regression = Regression(
        Experiment(seen, np.empty(0)),
        runs := Windows(np.array([0]), np.array([[2.2, 0.0]]), None),
        white_noise(np.array(NOISE)),
        base := with_unsure(seen, Model(plant(2.2, damping=0.5))),
        seen.time.size,
    )
    (term,) = (one for one in plain_laws("x1", regression.along(0)) if one.factors == "(x - sin(x))")
    for size in (11.5, 12.5):
        model = with_all(base, [guess_of(replace(term, size=size))])
        fitting = Fitting(regression.experiment, runs, np.array(NOISE), model, reduced_chi2=1e6)
        assert fitting.fit(model).squares <= fitting.squares(model)
