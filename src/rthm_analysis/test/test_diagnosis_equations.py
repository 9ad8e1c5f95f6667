"""Equations of one's own: effects that the spec has, with parameters that it calls uncertain, are fitted."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rthm_analysis.diagnosis.joining import joined
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.result import Diagnosis
from rthm_core.errors import InputError
from rthm_core.spec import Spec, apply, number_at, read_spec, write_spec

from .plain import MASS, plant, recorded

PENDULUM = {
    "block": "plant",
    "kind": "formula",
    "force": "-a * sin(2 * x)",
    "a": 2.0,
    "uncertainty": {"a": 0.3},
}
RUBBING = {"block": "plant", "kind": "coulomb_friction", "force": 0.05, "uncertainty": {"force": 0.5}}


def own_equation() -> Spec:
    return apply(plant(), {"effects": ["gravity", "bearing"], "gravity": PENDULUM, "bearing": RUBBING})


def diagnosed(gravity: float, friction: float) -> Diagnosis:
    evidence = recorded(
        lambda t, x, v: -gravity * math.sin(2.0 * x) - friction * math.copysign(1.0, v), force=1.5
    )
    spec = own_equation()
    return joined([physical_part(diagnose_physical(evidence, spec, np.empty(0), lambda said: None))], spec)


def test_an_uncertain_equation_is_kept_by_a_file() -> None:
    spec = own_equation()
    assert read_spec(write_spec(spec)) == spec
    assert number_at(spec, "gravity.uncertainty.a") == 0.3


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [
        ("gravity.uncertainty.force", 0.1, "must be left out, as only a may be uncertain"),
        ("bearing.uncertainty.force", -1.0, "at least 0"),
    ],
)
def test_an_uncertainty_of_what_is_no_parameter_is_refused(key: str, value: float, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        apply(own_equation(), {key: value})


def test_parameters_of_an_equation_of_ones_own_are_fitted_together() -> None:
    found = diagnosed(2.4, 0.08)
    assert found.verdict == "retuned" and not found.physics
    for name, true, unit in (("gravity.a", 2.4, "1"), ("bearing.force", 0.08, "N")):
        one = found.retuned[name]
        assert abs(one.value - true) < max(4.0 * one.std, 2e-3 * true)
        assert one.unit == unit
    assert "gravity.a 2." in found.words and "instead of 2 " in found.words
    patched = read_spec(found.patched)
    assert number_at(patched, "gravity.a") == found.retuned["gravity.a"].value


def test_an_equation_that_is_right_is_a_match() -> None:
    assert diagnosed(2.0, 0.05).verdict == "match"


@pytest.mark.parametrize("seed", [0, 1])
def test_numbers_of_a_force_and_of_a_mass_that_are_off_are_told_within_their_spread(seed: int) -> None:
    """``(M + a cos(2 x)^2) a - a sin(4 x) v^2 = -C v - K x + w - b x^3``, both numbers a tenth off."""
    lever = {"block": "plant", "kind": "inertia", "mass": "a * cos(2 * x)**2", "a": 0.9}
    spring = {"block": "plant", "kind": "formula", "force": "-b * x**3", "b": 9.0}
    equation = {
        "effects": ["lever", "spring"],
        "lever": lever | {"uncertainty": {"a": 0.2}},
        "spring": spring | {"uncertainty": {"b": 0.2}},
    }
    evidence = recorded(
        lambda t, x, v: math.sin(4.0 * x) * v**2 - 10.0 * x**3,
        force=1.2,
        seed=seed,
        mass=lambda t, x: MASS + math.cos(2.0 * x) ** 2,
    )
    spec = apply(plant(), equation)
    found = joined([physical_part(diagnose_physical(evidence, spec, np.empty(0), lambda said: None))], spec)
    assert found.verdict == "retuned" and not found.physics
    for name, true in (("lever.a", 1.0), ("spring.b", 10.0)):
        one = found.retuned[name]
        assert abs(one.value - true) < 2.0 * one.std < 0.02 * true
