"""A force between two dofs is found with its place, and one at a dof is not taken for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_analysis.diagnosis.result import Part, Value
from rthm_core.spec import Spec, spec_from_parameters

MASS, DAMPING = np.diag([1.2, 0.8]), np.array([[0.3, -0.1], [-0.1, 0.2]])
STIFFNESS = np.array([[30.0, -10.0], [-10.0, 18.0]])
STEP, SUBSTEPS, NOISE = 0.005, 4, (1e-4, 2e-3)

Law = Callable[[np.ndarray, np.ndarray], tuple[float, float]]
"""Forces on both dofs, N, from positions and velocities."""


def two_dofs(k: np.ndarray = STIFFNESS, **uncertainty: float) -> Spec:
    matrices = {"mass": MASS, "damping": DAMPING, "stiffness": k}
    section = {"dofs": ["x1", "x2"]} | {name: m.ravel().tolist() for name, m in matrices.items()}
    section |= {"initial_position": [0.0, 0.0], "initial_velocity": [0.0, 0.0]}
    unsure = {"uncertainty": {"plant": uncertainty}} if uncertainty else {}
    return spec_from_parameters({"plant": section} | unsure)


def recorded(
    law: Law,
    duration: float = 20.0,
    seed: int = 0,
    mass: Callable[[np.ndarray], np.ndarray] = lambda x: MASS,
) -> Evidence:
    """Positions and velocities of M(x) a = -C v - K x + load + law(x, v), with noise."""
    rng = np.random.default_rng(seed)
    omega, phase = rng.uniform(0.5, 9.0, (2, 12)), rng.uniform(0.0, 2.0 * np.pi, (2, 12))

    def load(t: float) -> np.ndarray:
        return 0.25 * np.sin(omega * t + phase).sum(axis=1)

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        x, v = y[:2], y[2:]
        force = load(t) - DAMPING @ v - STIFFNESS @ x + np.array(law(x, v))
        return np.concatenate([v, np.linalg.solve(mass(x), force)])

    count, h = round(duration / STEP) + 1, STEP / SUBSTEPS
    y, rows = np.zeros(4), np.empty((count, 4))
    for i in range(count):
        rows[i] = y
        for k in range(SUBSTEPS):
            t = i * STEP + k * h
            k1 = rate(t, y)
            k2 = rate(t + h / 2, y + h / 2 * k1)
            k3 = rate(t + h / 2, y + h / 2 * k2)
            y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(t + h, y + h * k3))
    stamps = np.arange(count, dtype=np.int64) * round(STEP * 1e9)
    channels = tuple(Channel(family, dof) for family in ("position", "velocity") for dof in ("x1", "x2"))
    noise = rng.normal(size=rows.shape) * np.repeat(NOISE, 2)
    loads = np.stack([load(t) for t in stamps / 1e9])
    nothing = np.empty(0, dtype=np.int64), np.empty((0, 0))
    return Evidence(stamps, *nothing, loads, channels, rows + noise, "force")


BETWEEN = "x1 relative to x2"


def between(force: float) -> tuple[float, float]:
    """A force on the first dof, the opposite on the second."""
    return force, -force


@pytest.mark.parametrize(
    ("law", "kind", "place", "value"),
    [
        (lambda x, v: between(-0.06 * np.tanh(1e4 * (v[0] - v[1]))), "coulomb_friction", BETWEEN, 0.06),
        (lambda x, v: between(-40.0 * (x[0] - x[1]) ** 3), "cubic_stiffness", BETWEEN, 40.0),
        (lambda x, v: (0.0, -0.5 * abs(v[1]) * v[1]), "quadratic_drag", "x2", 0.5),
    ],
    ids=["friction between", "spring between", "drag at one"],
)
def test_a_force_is_found_with_the_place_at_which_it_acts(
    law: Law, kind: str, place: str, value: float
) -> None:
    part = physical_part(diagnose_physical(recorded(law), two_dofs(), np.empty(0), lambda said: None))
    (one,) = part.physics
    assert (one.kind, one.place) == (kind, place) and place in one.words
    size = next(iter(one.parameters.values()))
    assert not isinstance(size, str) and size.value == pytest.approx(value, rel=0.03)
    assert not part.unexplained and not part.described
    (section,) = part.effects
    assert {one.variable for one in part.curves} & (
        {"x1 - x2", "d(x1 - x2)/dt"} if place == BETWEEN else {"v"}
    )
    assert section.get("relative_to") == ("x2" if "relative" in place else None)


def diagnosed(seen: Evidence, spec: Spec) -> Part:
    return physical_part(diagnose_physical(seen, spec, np.empty(0), lambda said: None))


def test_a_law_of_no_library_between_two_dofs_is_told_as_its_formula() -> None:
    found = diagnosed(recorded(lambda x, v: between(-60.0 * (x[0] - x[1]) ** 2 * (v[0] - v[1]))), two_dofs())
    (one,) = found.described
    assert (one.place, one.depends_on) == (BETWEEN, ("x", "v")) and not found.physics
    assert "the velocity of x1 relative to x2" in one.words
    size, product = str(one.formula).split(" * ", 1)
    assert float(size) == pytest.approx(-60.0, rel=0.02)
    assert product in ("v * x**2", "x**2 * v")


@pytest.mark.long
def test_each_entry_of_a_matrix_is_as_uncertain_as_the_spec_says() -> None:
    off = STIFFNESS * np.array([[1.04, 0.97], [0.97, 0.95]])
    seen = recorded(lambda x, v: between(-0.06 * np.tanh(1e4 * (v[0] - v[1]))))

    found = diagnosed(seen, two_dofs(off, stiffness=0.05))

    assert [(one.kind, one.place) for one in found.physics] == [("coulomb_friction", BETWEEN)]
    entries = [("plant.stiffness[0]", 0, 0), ("plant.stiffness[1]", 0, 1), ("plant.stiffness[3]", 1, 1)]
    for name, row, column in entries:
        assert found.retuned[name].value == pytest.approx(STIFFNESS[row, column], rel=0.01)


def test_a_gain_of_a_position_is_told_rather_than_masses_far_from_the_spec() -> None:
    seen = recorded(lambda x, v: (0.0, 0.0))
    less = replace(seen, measured=seen.measured * [1.0, 0.92, 1.0, 1.0])

    found = diagnosed(less, two_dofs(mass=0.02, damping=0.3, stiffness=0.1))

    (one,) = found.physics
    assert (one.block, one.kind, one.place) == ("sensor.position", "scale", "x2")
    assert isinstance(gain := one.parameters["scale"], Value) and gain.value == pytest.approx(0.92, abs=1e-3)
