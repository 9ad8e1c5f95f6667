"""The linear loop of stability and response is the difference of two simulations, for every kind."""

from __future__ import annotations

import numpy as np
import pytest
from every_kind import LOOP, SIZES, having, named, places

from rthm_analysis.lifted.commensurate import period_of
from rthm_analysis.lifted.lifted import Lifted
from rthm_analysis.lifted.linear_part import linear_part
from rthm_analysis.lifted.matrices import linear_loop
from rthm_analysis.response import response
from rthm_core.effects import effect
from rthm_core.engine import simulate
from rthm_core.physical.side import build
from rthm_core.spec import Spec, apply, scaled_motion, shipped_spec

AGREED = 1e-6
"""Largest difference over the largest derivative."""

PERIODS = 30
APART, APART_AT_REST = 1e-5, 1e-7
"""Starts of the two runs on either side of one, and of rest, where a drag is the smaller the nearer, m."""

AT_REST = {"load.plant.kind": "none", "plant.initial_position": 0.0}
DAMPED = {"plant.damping": [0.9], "numerical.damping": [0.9]}
LINEAR = [(block, kind) for block, kind in places() if effect(kind, block).linear]
ADDED = [(block, kind) for block, kind in places() if effect(kind, block).additive]

SMALL = ("cubic_stiffness", "quadratic_stiffness", "quadratic_drag", "end_stop", "clearance", "hardening")
SMALL += ("slack", "saturation")
"""Kinds that do nothing to a small motion about rest; the others that are left out, left out aloud, do."""

NEVER_SMALL = [one for one in places() if one not in LINEAR + ADDED and one[1] not in SMALL]


def beside(spec: Spec, by: float) -> Spec:
    return apply(spec, {"plant.initial_position": spec.plant.initial_position[0] + by})


def propagated(spec: Spec, by: float) -> np.ndarray:
    """Positions after each hyperperiod by the linear loop, by a unit of the plant's initial position."""
    low, high = (linear_part(beside(spec, side * by))[0] for side in (-1.0, 1.0))
    lifted = Lifted(linear_loop(low), period_of(low).cycle)
    state, loop, rows = (start(high, lifted) - start(low, lifted)) / (2.0 * by), lifted.loop, []
    for _ in range(PERIODS + 1):
        physical, numerical = state[: loop.a1.shape[0]], state[loop.a1.shape[0] : lifted.moving]
        rows.append(np.concatenate([loop.position1 @ physical, loop.position2 @ numerical]))
        state = lifted.monodromy() @ state
    return np.array(rows)


def start(spec: Spec, lifted: Lifted) -> np.ndarray:
    """Lifted state at the start of a test, before which everybody knows the true motion."""
    true = {f"{one.name}.scale": 1.0 for one in spec.effects if one.law.changes == "gain"}
    state, side = build(spec).state, spec.loop().numerical
    z = np.array([*side.initial_position, *side.initial_velocity])
    before = Lifted(linear_loop(apply(spec, true)), lifted.cycle)
    return before.at_rest_before(np.concatenate([state.q, state.y]), z)


def differenced(spec: Spec, by: float) -> np.ndarray:
    """The same by simulations of the whole loop with all of its physics."""
    period = period_of(linear_part(spec)[0]).cycle.hyperperiod
    runs = [
        simulate(beside(spec, side * by), PERIODS * period, period, energies=False) for side in (-1.0, 1.0)
    ]
    low, high = (np.hstack([run.plant_position, run.numerical_position]) for run in runs)
    return (high - low) / (2.0 * by)


def apart(spec: Spec, by: float) -> float:
    """Largest difference of the two over the largest derivative."""
    linear, whole = propagated(spec, by), differenced(spec, by)
    return float(np.abs(linear - whole).max() / np.abs(whole).max())


@pytest.mark.parametrize("place", LINEAR + ADDED, ids=named)
def test_the_linear_loop_is_the_difference_of_two_runs_anywhere(place: tuple[str, str]) -> None:
    for size in SIZES:
        spec = having(LOOP, *place, size)
        assert not linear_part(spec)[1]
        assert apart(spec, APART) < AGREED, size


@pytest.mark.parametrize("place", [one for one in places() if one[1] in SMALL], ids=named)
def test_a_law_that_is_small_at_rest_leaves_the_linear_loop_as_it_is(place: tuple[str, str]) -> None:
    for size in SIZES:
        assert apart(apply(having(LOOP, *place, size), AT_REST), APART_AT_REST) < AGREED, size


@pytest.mark.parametrize("place", NEVER_SMALL, ids=named)
def test_what_has_no_linear_part_is_said_to_be_left_out(place: tuple[str, str]) -> None:
    assert any("one" in said for said in linear_part(having(LOOP, *place, "middling"))[1])


@pytest.mark.parametrize("place", LINEAR, ids=named)
def test_the_sampled_response_is_the_fundamental_of_a_settled_motion(place: tuple[str, str]) -> None:
    period, cycles, rows = 2.4, 4, 400
    spec = having(apply(LOOP, DAMPED), *place, "small")
    w = 2.0 * np.pi / period
    load = {"dof": "x1", "kind": "harmonic", "amplitude": 1.0, "frequency": w, "phase": 0.0}
    run = simulate(apply(spec, {"load.plant": load}), (40 + cycles) * period, period / rows, energies=False)
    x = np.hstack([run.plant_position, run.numerical_position])[-cycles * rows :]
    expected = 2.0j * np.mean(x * np.exp(-1j * w * run.t[-cycles * rows :])[:, None], axis=0)
    found = response(spec, np.array([w])).ways["sampled"][0][:, 0]
    np.testing.assert_allclose(found, expected, rtol=1e-6)


def test_a_mass_that_depends_on_the_position_is_that_at_rest() -> None:
    lever = {"block": "plant", "kind": "inertia", "dof": "x1", "mass": "a * cos(b * x)", "a": 0.4, "b": 3.0}
    spec = apply(LOOP, AT_REST | {"effects": ["one"], "one": lever})
    for begun in (spec, beside(spec, 0.3)):
        linear, said = linear_part(begun)
        assert linear.plant.mass[0] == pytest.approx(LOOP.plant.mass[0] + 0.4, rel=1e-15)
        assert said == ("one (inertia of x1) is taken as at rest.",)
    assert apart(spec, APART) < AGREED


def test_a_coupling_that_depends_on_positions_is_that_at_rest() -> None:
    arm = {"block": "plant", "kind": "inertial_coupling", "dof": "x1", "relative_to": "x3"}
    arm |= {"mass": "a * cos(x - 2 * y)", "a": 0.4}
    spec = scaled_motion(apply(shipped_spec("three_mass"), {"effects": ["one"], "one": arm}), 1e-4)
    linear, said = linear_part(spec)
    assert linear.plant.mass[2] == linear.plant.mass[6] == pytest.approx(0.4, rel=1e-15)
    assert said == ("one (inertial_coupling of x1 relative to x3) is taken as at rest.",)
    found, expected = (simulate(one, 2.0, 0.01, energies=False).plant_position for one in (spec, linear))
    assert np.abs(found - expected).max() < 1e-6 * np.abs(expected).max()
