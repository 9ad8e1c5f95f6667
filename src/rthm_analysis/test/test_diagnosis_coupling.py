"""Equations of one's own with a mass that couples two dofs: what the spec calls uncertain of it is fitted."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_analysis.diagnosis.joining import joined
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.result import Diagnosis
from rthm_core.spec import Spec, apply

from .test_diagnosis_between import MASS, recorded, two_dofs

ARM, WEIGHT = 0.5, 4.0
"""Of the rig: the mass that couples a cart with its pole, kg m, and the largest moment of the weight, N m."""


def cart_and_pole(seed: int) -> Evidence:
    """A cart on a spring with a pole, ``m(y) = ARM cos(2 y)``; their own masses are those of the plant."""

    def forces(x: np.ndarray, v: np.ndarray) -> tuple[float, float]:
        return 2.0 * ARM * float(np.sin(2.0 * x[1])) * v[1] ** 2, -WEIGHT * float(np.sin(2.0 * x[1]))

    def mass(x: np.ndarray) -> np.ndarray:
        return MASS + ARM * np.cos(2.0 * x[1]) * np.array([[0.0, 1.0], [1.0, 0.0]])

    return recorded(forces, duration=12.0, seed=seed, mass=mass)


def stated(arm: float, weight: float) -> Spec:
    between = {"block": "plant", "kind": "inertial_coupling", "dof": "x1", "relative_to": "x2"}
    pole = between | {"mass": "a * cos(2 * y)", "a": arm, "uncertainty": {"a": 0.2}}
    gravity = {"block": "plant", "kind": "formula", "dof": "x2", "force": "-b * sin(2 * x)", "b": weight}
    gravity |= {"uncertainty": {"b": 0.2}}
    return apply(two_dofs(), {"effects": ["pole", "gravity"], "pole": pole, "gravity": gravity})


def diagnosed(seen: Evidence, spec: Spec) -> Diagnosis:
    return joined([physical_part(diagnose_physical(seen, spec, np.empty(0), lambda said: None))], spec)


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.long)])
def test_numbers_of_a_coupling_and_of_a_force_that_are_off_are_told_within_their_spread(seed: int) -> None:
    found = diagnosed(cart_and_pole(seed), stated(0.9 * ARM, 1.1 * WEIGHT))
    assert found.verdict == "retuned" and not found.physics
    for name, true in (("pole.a", ARM), ("gravity.b", WEIGHT)):
        one = found.retuned[name]
        assert abs(one.value - true) < 2.5 * one.std < 0.02 * true


def test_a_coupling_that_is_right_is_a_match() -> None:
    assert diagnosed(cart_and_pole(2), stated(ARM, WEIGHT)).verdict == "match"
