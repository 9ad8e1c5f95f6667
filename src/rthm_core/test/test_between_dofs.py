"""A law between two dofs gets their motion apart, and acts on both with opposite signs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rthm_core.engine import Trajectory, simulate
from rthm_core.errors import InputError
from rthm_core.spec import Spec, apply, read_spec, spec_from_parameters, write_spec

MASS, STIFFNESS = [2.0, 0.0, 0.0, 1.0], [30.0, 0.0, 0.0, 8.0]


def two_dofs(stiffness: list[float] = STIFFNESS, **effects: dict[str, Any]) -> Spec:
    """Two masses on springs of their own, and laws between them or at one."""
    section = {
        "dofs": ["x1", "x2"],
        "mass": MASS,
        "damping": [0.1, 0.0, 0.0, 0.05],
        "stiffness": stiffness,
        "initial_position": [0.2, -0.1],
        "initial_velocity": [0.0, 0.5],
    }
    placed = {name: {"block": "plant", "dof": "x1"} | one for name, one in effects.items()}
    return spec_from_parameters({"plant": section, "effects": list(placed)} | placed)


def between(kind: str, **parameters: float | str) -> dict[str, Any]:
    return {"kind": kind, "relative_to": "x2"} | parameters


def run(spec: Spec) -> Trajectory:
    return simulate(spec, 8.0, 0.01)


COUPLED = [35.0, -5.0, -5.0, 13.0]
"""The stiffness with a spring of 5 N/m between the two."""


@pytest.mark.parametrize(
    ("law", "accuracy"),
    [
        (between("formula", force="-a * x", a=5.0), 1e-8),
        ({"dof": "x2", "kind": "formula", "relative_to": "x1", "force": "-5 * x"}, 1e-8),
        (between("clearance", gap=0.0, stiffness=5.0), 1e-8),
        (between("maxwell_branch", stiffness=5.0, damping=1e9), 1e-5),
    ],
    ids=["written", "turned round", "play of none", "linear"],
)
def test_a_spring_between_two_dofs_is_an_entry_of_the_matrix(law: dict[str, Any], accuracy: float) -> None:
    known, found = run(two_dofs(COUPLED)), run(two_dofs(spring=law))
    if law["kind"] == "maxwell_branch":  # which is relaxed at the start, where the two are 0.3 m apart
        pull = {"kind": "constant_load", "force": 1.5}
        known = run(two_dofs(COUPLED, one=pull, other=pull | {"dof": "x2", "force": -1.5}))
    assert np.abs(known.plant_position - found.plant_position).max() < accuracy
    assert np.abs(run(two_dofs()).plant_position - found.plant_position).max() > 0.01


def test_a_load_between_two_dofs_pulls_one_and_pushes_the_other() -> None:
    tone = {"amplitude": 0.4, "frequency": 3.0, "phase": 0.2}
    one = run(two_dofs(tone=between("harmonic_load", **tone)))
    opposite = {"dof": "x2", "kind": "harmonic_load"} | tone | {"amplitude": -0.4}
    both = run(two_dofs(here={"kind": "harmonic_load"} | tone, there=opposite))
    assert np.abs(one.plant_position - both.plant_position).max() < 1e-12


@pytest.mark.parametrize("kind", ["coulomb_friction", "stribeck_friction"])
def test_friction_between_two_free_masses_stops_their_motion_apart_and_keeps_momentum(kind: str) -> None:
    sizes = {"force": 0.3} if kind == "coulomb_friction" else {
        "coulomb_force": 0.3, "static_force": 0.4, "stribeck_velocity": 0.05
    }  # fmt: skip
    free = apply(
        two_dofs(rub=between(kind, **sizes)), {"plant.stiffness": [0.0] * 4, "plant.damping": [0.0] * 4}
    )
    moved = run(free)
    velocity = moved.plant_velocity
    momentum = 2.0 * velocity[:, 0] + velocity[:, 1]
    assert np.abs(momentum - momentum[0]).max() < 1e-9
    apart = np.abs(velocity[:, 0] - velocity[:, 1])
    assert apart[0] == pytest.approx(0.5) and apart[-1] < 1e-12
    if kind == "coulomb_friction":
        # Both masses slow down by 0.3 N: apart by 0.3 (1/2 + 1) m/s^2, for 0.5 / 0.45 s.
        assert 0.01 * np.argmax(apart < 1e-9) == pytest.approx(0.5 / 0.45, abs=0.011)


def test_two_dofs_that_stick_to_each_other_and_to_the_ground_come_loose_each_by_itself() -> None:
    ground, rub = {"kind": "coulomb_friction", "force": 0.9}, between("coulomb_friction", force=0.3)
    moved = run(two_dofs(ground=ground, rub=rub))
    energy = np.diff(0.5 * (moved.plant_velocity**2 @ np.diag(np.reshape(MASS, (2, 2))))
                     + 0.5 * (moved.plant_position**2 @ np.diag(np.reshape(STIFFNESS, (2, 2)))))  # fmt: skip
    assert energy.max() < 1e-9  # nothing puts energy in
    assert np.abs(moved.plant_velocity[-1]).max() < 1e-6


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (
            between("constant_load", force=1.0) | {"relative_to": "x3"},
            "relative_to is 'x3', but must be one of x2",
        ),
        (
            between("constant_load", force=1.0) | {"relative_to": "x1"},
            "relative_to is 'x1', but must be one of x2",
        ),
        ({"block": "sensor.position", "kind": "bias", "bias": 0.1, "relative_to": "x2"}, "one.relative_to"),
    ],
)
def test_a_place_between_two_dofs_names_two_of_the_plant(law: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError) as error:
        two_dofs(one=law)
    assert words in str(error.value) and "\n" not in str(error.value)


def test_a_spec_with_a_law_between_two_dofs_is_written_and_read_again(tmp_path: Any) -> None:
    spec = two_dofs(rub=between("coulomb_friction", force=0.3))
    file = tmp_path / "spec.yaml"
    file.write_text(write_spec(spec))
    assert read_spec(file).effects == spec.effects
    assert spec.effects[0].place == "x1 relative to x2"
