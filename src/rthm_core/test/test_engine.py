"""The exact engine against brute force, closed forms and its own balance of energy."""

import numpy as np
import pytest
from brute_force import STEP_NS, brute_force

from rthm_core.engine import simulate
from rthm_core.spec import apply, shipped_spec

CUBIC = {"block": "plant", "kind": "cubic_stiffness", "dof": "x1", "coefficient": 8.0}
DRAG = {"block": "plant", "kind": "quadratic_drag", "dof": "x1", "coefficient": 0.3}


def with_effects(spec, **effects):
    """The spec with effects added, by name."""
    return apply(spec, {"effects": list(effects), **effects})


def difference(spec, duration, **nonlinear):
    """Largest difference of any position between engine and brute force, in m."""
    one, two = brute_force(spec, duration, **nonlinear)
    found = simulate(spec, duration, 0.0012, energies=False)
    every = 1_200_000 // STEP_NS
    n1, n2 = found.plant_position.shape[1], found.numerical_position.shape[1]
    rows = found.t.size
    return max(
        np.abs(found.plant_position - one[::every, :n1][:rows]).max(),
        np.abs(found.numerical_position - two[::every, :n2][:rows]).max(),
    )


@pytest.mark.parametrize("name", ["paper", "three_mass"])
def test_engine_agrees_with_brute_force_to_a_nanometre(name):
    assert difference(shipped_spec(name), 20.0) < 1e-9


def test_nonlinear_engine_agrees_with_brute_force_to_a_nanometre():
    spec = with_effects(shipped_spec("paper"), spring=CUBIC, water=DRAG)
    assert difference(spec, 20.0, cubic=np.array([8.0]), drag=np.array([0.3])) < 1e-9


def test_delays_of_zero_pass_at_once():
    still = {f"timing.{name}": 0.0 for name in ("tau1", "tau2", "tau3", "tau4")}
    assert difference(apply(shipped_spec("paper"), still), 5.0) < 1e-9


def test_without_delays_and_holds_the_hybrid_becomes_the_ideal_system():
    timing = {f"timing.{name}": 0.0 for name in ("tau1", "tau2", "tau3", "tau4")}
    timing |= {f"timing.{name}": 2e-5 for name in ("td1", "td2", "td3")}
    spec = apply(shipped_spec("paper"), timing)
    hybrid, ideal = (simulate(spec, 2.0, 0.01, system, energies=False) for system in ("hybrid", "ideal"))
    coarse = simulate(shipped_spec("paper"), 2.0, 0.01, energies=False)
    error = np.abs(hybrid.plant_position - ideal.plant_position).max()
    assert error < 0.01 * np.abs(coarse.plant_position - ideal.plant_position).max()


LOADED = {
    "load.plant": {"dof": "x1", "kind": "harmonic", "amplitude": 1.0, "frequency": 2.4, "phase": 0.3},
    "load.numerical": {
        "dof": "x2",
        "kind": "multisine",
        "rms": 0.5,
        "low": 1.0,
        "high": 9.0,
        "count": 7,
        "seed": 3,
        "ramp": 2.0,
    },
}
WIRE = {"block": "wire", "actuator": "a1"}
CASES = {
    "linear": (LOADED, {}),
    "poles": ({"actuator.motor_poles": [400.0, 2000.0]}, {}),
    "lag": ({}, {"band": {"block": "motor", "kind": "lag", "actuator": "a1", "time_constant": 0.003}}),
    "friction": ({}, {"guide": {"block": "plant", "kind": "coulomb_friction", "dof": "x1", "force": 0.05}}),
    "smooth": (LOADED, {"spring": CUBIC, "water": DRAG}),
    "stop": (
        {},
        {
            "stop": {
                "block": "plant",
                "kind": "end_stop",
                "dof": "x1",
                "position": 0.2,
                "stiffness": 300.0,
                "damping": 2.0,
            }
        },
    ),
    "slack": ({"actuator.pretension": [1.5]}, {}),
}


@pytest.mark.parametrize("case", CASES)
def test_energy_balance_closes(case):
    changes, effects = CASES[case]
    spec = (
        with_effects(apply(shipped_spec("paper"), changes), **effects)
        if effects
        else apply(shipped_spec("paper"), changes)
    )
    found = simulate(spec, 20.0, 0.0012)
    assert np.isfinite(found.plant_position).all()
    assert np.abs(found.balance_error).max() < 1e-9
    if effects and case != "lag":
        assert found.energies["E_effects"][-1] < -1e-3 or case == "stop"


def test_a_loop_whose_motion_escapes_in_finite_time_is_no_number_from_there_on():
    pull = {"block": "plant", "kind": "quadratic_stiffness", "dof": "x1", "coefficient": 60.0}
    spec = with_effects(apply(shipped_spec("paper_noisy"), {"plant.initial_position": -0.5}), pull=pull)
    there = np.isfinite(simulate(spec, 2.0, 0.01).plant_position[:, 0])
    assert there[0] and not there[np.argmin(there) :].any()


def test_full_transmission_approaches_its_static_stiffness():
    """The corrected (5): with a light pulley, (3a) acts as k_tot alone."""
    spec = shipped_spec("transmission")
    light = apply(spec, {"actuator.transmission.inertia": 1e-7, "actuator.transmission.damping": 1e-6})
    static = apply(spec, {"actuator.transmission.inertia": 0.0, "actuator.transmission.damping": 0.0})
    t = spec.actuator.transmission
    assert spec.k_tot[0] == pytest.approx(1.0 / (1.0 / t.wire + t.radius**2 / t.spring), rel=1e-12)
    moving, still = (simulate(one, 2.0, 0.01, energies=False).plant_position for one in (light, static))
    heavy = simulate(spec, 2.0, 0.01, energies=False).plant_position
    assert np.abs(moving - still).max() < 1e-4
    assert np.abs(moving - still).max() < np.abs(heavy - still).max()


def decay(**effects):
    spec = apply(
        shipped_spec("decay"),
        {
            "plant.mass": [1.0],
            "plant.damping": [0.0],
            "plant.stiffness": [4.0],
            "plant.initial_position": [0.5],
        },
    )
    return with_effects(spec, **effects)


def test_coulomb_decay_is_the_closed_form():
    """Each half cycle turns 2 F / k nearer to zero, and the mass stays where it turns within F / k."""
    force, k = 0.15, 4.0
    found = simulate(
        decay(guide={"block": "plant", "kind": "coulomb_friction", "dof": "x1", "force": force}), 20.0, 0.001
    )
    half = np.pi / 2.0
    amplitude, position, expected = 0.5, 0.5, np.empty(found.t.size)
    for row, t in enumerate(found.t):
        number = int(t // half)
        turning = [0.5 - 2.0 * force / k * i for i in range(20)]
        last = next(i for i, a in enumerate(turning) if a <= force / k)
        if number >= last:
            expected[row] = turning[last] * (-1) ** last
        else:
            amplitude = turning[number] - force / k
            position = force / k + amplitude * np.cos(2.0 * (t - number * half))
            expected[row] = position * (-1) ** number
    assert np.abs(found.plant_position[:, 0] - expected).max() < 1e-11


def test_end_stop_without_damping_gives_back_what_it_took():
    found = simulate(
        decay(
            stop={
                "block": "plant",
                "kind": "end_stop",
                "dof": "x1",
                "position": -0.2,
                "stiffness": 500.0,
                "damping": 0.0,
            }
        ),
        20.0,
        0.001,
    )
    x, v = found.plant_position[:, 0], found.plant_velocity[:, 0]
    stop = np.where(x < -0.2, 0.5 * 500.0 * (x + 0.2) ** 2, 0.0)
    energy = 0.5 * v**2 + 2.0 * x**2 + stop
    assert x.min() < -0.2
    assert np.abs(energy - energy[0]).max() < 1e-9
