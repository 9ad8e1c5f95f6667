"""Fits stay with what is physically possible, and say what the data leave open."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_analysis.diagnosis.fitting.sums import Sums
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_core.effects import BLOCKS, effect, kinds
from rthm_core.effects.possible import Seen
from rthm_core.quantity import Text

from .side import PAPER

SEEN = Seen(step=0.001, duration=10.0, mass=1.2, lowest=-0.5, highest=0.5, speed=2.0)


def fitted_to(kind: str, start: dict[str, float], wanted: dict[str, float]) -> dict[str, float | str]:
    """Parameters that a fit ends at which begins at some values and wants others."""
    model = Model(PAPER).plus(EffectInstance("plant", kind, "x1", dict(start), SEEN), tuple(start), {})
    return model.at(np.array([wanted[key] for key in start])).effect_values(0)


@pytest.mark.parametrize(
    ("kind", "start", "wanted", "found"),
    [
        ("clearance", {"gap": 0.1, "stiffness": 1.0}, {"stiffness": -3.0}, {"stiffness": 0.0}),
        ("clearance", {"gap": 0.1, "stiffness": 1.0}, {"gap": 1e-9}, {"gap": 0.02}),
        ("end_stop", {"position": 0.3, "stiffness": 1.0}, {"position": -4e-13}, {"position": 0.02}),
        ("end_stop", {"position": -0.3, "stiffness": 1.0}, {"position": -0.7}, {"position": -0.48}),
        (
            "end_stop",
            {"position": 0.3, "stiffness": 5.0, "damping": 0.1},
            {"damping": 40.0},
            {"damping": 10.0 * 5.0 * (0.5 - 0.3) / 2.0},
        ),
        (
            "stribeck_friction",
            {"coulomb_force": 0.1, "static_force": 0.2, "stribeck_velocity": 0.1},
            {"coulomb_force": 0.3, "stribeck_velocity": 30.0},
            {"static_force": 0.3, "stribeck_velocity": 1.0},
        ),
        (
            "bouc_wen",
            {"alpha": 1.0, "A": 1.0, "beta": 2.0, "gamma": 1.0, "n": 1.0},
            {"gamma": -9.0, "n": 13.0},
            {"gamma": -4.0, "n": 5.0},
        ),
        (
            "hidden_mode",
            {"mass": 0.1, "frequency": 9.0, "damping_ratio": 0.1},
            {"mass": 5.0, "frequency": 1e5, "damping_ratio": 7.0},
            {"mass": 1.2, "frequency": 500.0 * np.pi, "damping_ratio": 1.0},
        ),
        ("maxwell_branch", {"stiffness": 2.0, "damping": 1.0}, {"damping": 1e9}, {"damping": 20.0}),
        (
            "harmonic_load",
            {"amplitude": 1.0, "frequency": 5.0, "phase": 0.0},
            {"frequency": 1e-3},
            {"frequency": 0.2 * np.pi},
        ),
    ],
)
def test_a_fit_gets_no_value_that_is_not_possible(
    kind: str, start: dict[str, float], wanted: dict[str, float], found: dict[str, float]
) -> None:
    assert fitted_to(kind, start, start | wanted) == pytest.approx(start | wanted | found)


def test_a_parameter_at_the_end_of_what_is_possible_is_at_a_bound() -> None:
    added = EffectInstance("plant", "clearance", "x1", {"gap": 0.1, "stiffness": 1.0}, SEEN)
    model = Model(PAPER).plus(added, ("gap", "stiffness"), {})
    assert [p.at_bound for p in model.parameters] == [False, False]
    assert [p.at_bound for p in model.at(np.array([0.1, -1.0])).parameters] == [False, True]


@pytest.mark.parametrize("block", BLOCKS)
def test_what_a_kind_says_of_its_parameters_is_about_its_parameters(block: str) -> None:
    for law in (effect(kind, block) for kind in kinds(block)):
        numbers = {name for name, one in law.parameters.items() if not isinstance(one, Text)}
        assert {*law.possible, *law.secondary} <= numbers
        for plainer in law.plainer:
            values = dict.fromkeys(numbers, 1.0)
            asked = set(effect(plainer.kind, block).parameters)
            assert set(plainer.values(values)) == asked and set(plainer.grows) <= numbers
        for twin in law.twins:
            own = {name: 2.0 + place for place, name in enumerate(sorted(numbers))}
            theirs = twin.values(own)
            assert theirs.keys() == effect(twin.kind, block).parameters.keys()
            (back,) = (one for one in effect(twin.kind, block).twins if one.kind == law.kind)
            assert back.values(theirs) == pytest.approx(own)


def test_a_kind_is_identified_when_its_main_parameters_are() -> None:
    law = effect("bouc_wen", "plant")
    values = {"alpha": 5.0, "beta": 2.0, "gamma": 0.1, "n": 1.2}
    known = {"alpha": 0.1, "beta": 0.2, "gamma": 3.0, "n": 0.1}
    assert law.identified(values, known)
    assert not law.identified(values, known | {"n": 13.0})


@pytest.mark.parametrize(
    ("kind", "name"), [("end_stop", "position"), ("clearance", "gap"), ("harmonic_load", "amplitude")]
)
def test_where_a_contact_is_and_how_large_a_tone_must_be_known_well(kind: str, name: str) -> None:
    law = effect(kind, "plant")
    values = dict.fromkeys(law.parameters, 2.0)
    known = dict.fromkeys(law.parameters, 0.02)
    assert law.identified(values, known) and not law.identified(values, known | {name: 0.2})


def sums_of(columns: np.ndarray, residual: np.ndarray) -> Sums:
    parts = np.array_split(np.arange(residual.size), 20)
    hessian = np.stack([columns[:, p] @ columns[:, p].T for p in parts])
    gradient = np.stack([columns[:, p] @ residual[p] for p in parts])
    nothing = np.zeros(columns.shape[0])
    return Sums(hessian, gradient, np.array([residual[p] @ residual[p] for p in parts]), nothing, nothing)


def test_what_the_data_leave_open_has_an_infinite_standard_deviation() -> None:
    rng = np.random.default_rng(1)
    a, b, residual = rng.normal(size=(3, 4000))
    stds = np.sqrt(np.diag(sums_of(np.stack([a, 1e6 * b, 2.0 * b, 0.0 * a]), residual).covariance()))
    assert stds[1] == stds[2] == stds[3] == np.inf
    assert stds[0] == pytest.approx(4000**-0.5, rel=0.5)


def test_parameters_of_very_different_size_are_determined_all_the_same() -> None:
    rng = np.random.default_rng(2)
    a, b, residual = rng.normal(size=(3, 4000))
    stds = np.sqrt(np.diag(sums_of(np.stack([1e-7 * a, 1e7 * b]), residual).covariance()))
    assert stds == pytest.approx(np.array([1e7, 1e-7]) * 4000**-0.5, rel=0.5)
