"""Energies of systems without a loop: every term on its own, so that the balance is a check."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rthm_core.energy import TERMS
from rthm_core.engine import simulate
from rthm_core.spec import apply, shipped_spec

WAVE = {"dof": "x1", "kind": "harmonic", "amplitude": 1.0, "frequency": 2.4, "phase": 0.3}
PUSH = {"dof": "x2", "kind": "constant", "force": 0.4}
LOADED = {"load.plant": WAVE, "load.numerical": PUSH}
RUB = {"block": "plant", "dof": "x1", "kind": "coulomb_friction", "force": 0.1}
CUBIC = {"block": "plant", "dof": "x1", "kind": "cubic_stiffness", "coefficient": 8.0}
STOP = {
    "block": "plant",
    "dof": "x1",
    "kind": "end_stop",
    "position": 0.3,
    "stiffness": 100.0,
    "damping": 0.0,
}
ALONE = ("numerical", "interface", "actuator", "timing", "load.numerical")


def with_effects(spec, *parts):
    effects = {f"e{i}": part for i, part in enumerate(parts)}
    return apply(spec, {"effects": list(effects)} | effects)


def alone(spec):
    return apply(spec, dict.fromkeys(ALONE))


@pytest.mark.parametrize("system", ["ideal", "taylor"])
def test_the_balance_of_a_linear_system_closes(system):
    found = simulate(apply(shipped_spec("paper"), LOADED), 10.0, 0.0012, system)
    assert np.abs(found.balance_error).max() < 1e-11 * found.energies["E_total"].max()
    assert np.abs(found.energies["E_load"]).max() > 0.1


def stored(stretch, stiffness):
    """Energy of a spring beyond a gap."""
    return 0.5 * stiffness * np.square(np.maximum(stretch, 0.0))


WORKS = {
    "cubic": ((CUBIC,), lambda x: -2.0 * (x**4 - x[0] ** 4)),
    "rub": ((RUB,), lambda x: -0.1 * np.concatenate([[0.0], np.cumsum(np.abs(np.diff(x)))])),
    "stop": ((STOP,), lambda x: stored(x[0] - 0.3, 100.0) - stored(x - 0.3, 100.0)),
}


@pytest.mark.parametrize("system", ["ideal", "taylor", "alone"])
@pytest.mark.parametrize("which", WORKS)
def test_effects_do_the_work_of_their_force_along_the_way(system, which):
    parts, expected = WORKS[which]
    spec = apply(shipped_spec("paper"), {"load.plant": WAVE})
    spec = with_effects(alone(spec) if system == "alone" else spec, *parts)
    found = simulate(spec, 6.0, 0.0012, "hybrid" if system == "alone" else system)
    work = expected(found.plant_position[:, 0])
    assert np.abs(found.energies["E_effects"] - work).max() < 1e-5 * np.abs(work).max()


def test_an_ideal_system_has_no_errors_and_no_work_of_effects_that_are_not_there():
    energies = simulate(shipped_spec("paper"), 10.0, 0.0012, "ideal").energies
    for term in ("E_num", "E_ff", "E_fx", "E_load"):
        assert not energies[term].any()
    assert np.abs(energies["E_effects"]).max() < 1e-12
    assert np.all(np.diff(energies["E_damping"]) <= 0.0)


def test_the_approximation_has_the_errors_of_the_loop_to_first_order():
    spec = shipped_spec("paper")
    loop, approximation = (simulate(spec, 20.0, 0.0012, system).energies for system in ("hybrid", "taylor"))
    for term in TERMS[:3]:
        assert approximation[term][-1] == pytest.approx(loop[term][-1], rel=0.2)


def test_rows_further_apart_change_no_energy():
    spec = with_effects(apply(shipped_spec("paper"), LOADED), CUBIC)
    fine, coarse = (simulate(spec, 4.0, sample, "ideal").energies for sample in (0.001, 0.02))
    for term in (*TERMS, "E_total"):
        assert np.abs(fine[term][::20] - coarse[term]).max() < 1e-8


def test_a_motion_that_grows_without_bound_ends_where_it_leaves_every_bound():
    pull = {"block": "plant", "dof": "x1", "kind": "quadratic_stiffness", "coefficient": 25.0}
    spec = apply(with_effects(shipped_spec("decay"), pull), {"plant.initial_position": -0.5})
    found = simulate(spec, 10.0, 0.001, energies=False)
    there = np.isfinite(found.plant_position[:, 0])
    m, c, k = (value[0] for value in (spec.plant.mass, spec.plant.damping, spec.plant.stiffness))

    def rate(t, y):
        return [y[1], -(c * y[1] + k * y[0] + 25.0 * y[0] ** 2) / m]

    def far(t, y):
        return y[0] + 1e6

    far.terminal = True
    alone_left = solve_ivp(rate, (0.0, 10.0), [-0.5, 0.0], events=far, rtol=1e-10, atol=1e-10).t_events[0][0]
    left = found.t[there][-1]
    assert not there[np.argmin(there) :].any()
    assert left == pytest.approx(alone_left, abs=0.003)
