"""Frequency response: printed equations, limits, and long simulations."""

import numpy as np
import pytest

from rthm_analysis.response import WAYS, response
from rthm_core.engine import simulate
from rthm_core.errors import InputError
from rthm_core.spec import apply, shipped_spec

PAPER = shipped_spec("paper")


def printed(spec, s, *, holds=False):
    """(28) to (30) of the paper, as printed, for two masses."""
    m1, m2 = spec.plant.mass[0], spec.numerical.mass[0]
    c1, c2, c3 = spec.plant.damping[0], spec.interface.damping[0], spec.numerical.damping[0]
    k1, k2, k3 = spec.plant.stiffness[0], spec.interface.stiffness[0], spec.numerical.stiffness[0]
    t, k_tot = spec.timing, spec.k_tot[0]
    tau1, tau2 = t.tau1 + holds * (t.td1 + t.td3) / 2, t.tau2 + holds * (t.td1 + t.td2) / 2
    tau234, tau14 = tau2 + t.tau3 + t.tau4, tau1 + t.tau4
    tau34 = t.tau3 + t.tau4 + holds * t.td2 / 2
    h = 1.0
    for pole in spec.actuator.motor_poles or ():
        h = h / (1.0 + s / pole)
    late2, late34, late234, late14 = (np.exp(-tau * s) for tau in (tau2, tau34, tau234, tau14))
    mass = np.diag([m1, m2])
    damping = np.array([[c1 + c2 * h * late234, -c2 * h * late34], [-c2 * late2, c2 + c3]])
    stiffness = np.array(
        [[k1 + k_tot * (1 - h * late14) + k2 * h * late234, -k2 * h * late34], [-k2 * late2, k2 + k3]]
    )
    return np.linalg.inv(mass * s**2 + damping * s + stiffness)


@pytest.mark.parametrize("poles", [{}, {"actuator.motor_poles": [400.0, 2000.0]}])
@pytest.mark.parametrize("holds", [False, True])
def test_delays_are_the_printed_equations(poles, holds):
    spec = apply(PAPER, poles)
    omega = np.array([0.3, 1.0, 2.4, 4.1, 9.0])
    found = response(spec, omega).ways["delays_and_holds" if holds else "delays"]
    expected = [printed(spec, 1j * w, holds=holds) for w in omega]
    np.testing.assert_allclose(found, expected, rtol=1e-10)


def test_ideal_and_taylor_are_the_corrected_matrices():
    t, k2, c2 = PAPER.timing, 6.0, 0.1
    tau1, tau2, tau3 = t.tau1 + (t.td1 + t.td3) / 2, t.tau2 + (t.td1 + t.td2) / 2, t.tau3 + t.td2 / 2
    tau14, tau234, tau34 = tau1 + t.tau4, tau2 + t.tau3 + t.tau4, tau3 + t.tau4
    stiffness = np.array([[18.0, -6.0], [-6.0, 12.0]])
    ideal = np.array([[0.15, -0.1], [-0.1, 0.15]])
    mass = np.diag([1.2, 1.5])
    mass_tau = c2 * np.array([[-tau234, tau34], [tau2, 0.0]])
    damping_tau = k2 * np.array([[-tau234, tau34], [tau2, 0.0]]) + np.diag([40.0 * tau14, 0.0])
    found = response(PAPER, np.array([2.4])).ways
    s = 2.4j
    np.testing.assert_allclose(
        found["ideal"][0], np.linalg.inv(mass * s**2 + ideal * s + stiffness), rtol=1e-11
    )
    expected = np.linalg.inv((mass + mass_tau) * s**2 + (ideal + damping_tau) * s + stiffness)
    np.testing.assert_allclose(found["taylor"][0], expected, rtol=1e-11)


def test_near_resonance_delays_alone_read_too_high_and_with_holds_they_agree():
    omega = np.array([2.3, 2.4, 2.5])
    ways = response(PAPER, omega).ways
    high = np.abs(ways["delays"] / ways["sampled"]) - 1.0
    assert high[1].min() > 0.15 and high[1].max() < 0.20
    assert np.abs(np.abs(ways["delays_and_holds"] / ways["sampled"]) - 1.0).max() < 0.015


def test_without_delays_and_holds_all_ways_are_the_ideal_system():
    still = {f"timing.tau{i}": 0.0 for i in range(1, 5)} | {f"timing.td{i}": 1e-6 for i in range(1, 4)}
    ways = response(apply(PAPER, still), np.array([1.0, 2.4])).ways
    for way in WAYS:
        np.testing.assert_allclose(ways[way], ways["ideal"], rtol=2e-3)


def simulated(spec, side, dof, w, settle, cycles, rows):
    """Fundamental components of all positions in the settled motion under a load sin(w t)."""
    load = {"dof": dof, "kind": "harmonic", "amplitude": 1.0, "frequency": w, "phase": 0.0}
    period = 2.0 * np.pi / w
    sample = period / rows
    found = simulate(apply(spec, {f"load.{side}": load}), (settle + cycles) * period, sample, energies=False)
    x = np.hstack([found.plant_position, found.numerical_position])[-cycles * rows :]
    t = found.t[-cycles * rows :]
    return 2.0j * np.mean(x * np.exp(-1j * w * t)[:, None], axis=0)


DAMPED = {"plant.damping": [0.9], "numerical.damping": [0.9]}
SLOW = {"timing.td1": 0.1, "timing.td2": 0.2, "timing.td3": 0.1, "timing.tau1": 0.05, "timing.tau4": 0.03}
POLES = {"actuator.motor_poles": [400.0, 2000.0]}


@pytest.mark.parametrize("changes", [DAMPED, DAMPED | SLOW, DAMPED | POLES], ids=["fast", "slow", "motor"])
@pytest.mark.parametrize("load", [("plant", "x1"), ("numerical", "x2")], ids=["w1", "w2"])
def test_sampled_response_is_the_fundamental_of_a_long_simulation(changes, load):
    """Period and hyperperiod have a common multiple, so the means over it leave the fundamental alone."""
    spec = apply(PAPER, changes)
    period = 12 * 0.2 if changes.get("timing.td1") else 2.4
    w = 2.0 * np.pi / period
    expected = simulated(spec, *load, w, settle=40, cycles=4, rows=8000 if "timing.td1" in changes else 2000)
    found = response(spec, np.array([w])).ways["sampled"][0]
    np.testing.assert_allclose(found[:, 0 if load[0] == "plant" else 1], expected, rtol=1e-6)


def test_sampled_response_of_several_dofs_and_actuators_is_that_of_a_simulation():
    spec = shipped_spec("three_mass")
    w = 2.0 * np.pi / 1.6
    result = response(spec, np.array([w]))
    assert result.dofs == ("x1", "x2", "x3", "y1", "y2")
    for column, load in ((1, ("plant", "x2")), (4, ("numerical", "y2"))):
        expected = simulated(spec, *load, w, settle=85, cycles=4, rows=1600)
        np.testing.assert_allclose(result.ways["sampled"][0][:, column], expected, rtol=1e-6)


def test_every_pair_of_dofs_has_five_ways():
    found = response(shipped_spec("three_mass"), np.array([1.0, 3.0])).as_dict()["response"]
    assert len(found) == 2 * 5 * 5
    for one in found:
        assert set(one) == {"omega", "input", "output", *WAYS}
        assert all(set(one[way]) == {"amplitude", "phase_deg"} for way in WAYS)


def test_a_frequency_of_zero_is_refused_in_a_sentence():
    with pytest.raises(InputError, match="positive"):
        response(PAPER, np.array([0.0]))


COMPENSATORS = {
    "taylor": {"actuator.compensator": "taylor"},
    "polynomial 1": {"actuator.compensator": "polynomial", "actuator.compensator_order": 1},
    "polynomial 3": {"actuator.compensator": "polynomial", "actuator.compensator_order": 3},
    "with motor": {"actuator.compensator": "taylor", "actuator.motor_poles": [400.0, 2000.0]},
    "with Td4": {"actuator.compensator": "polynomial", "actuator.compensator_order": 2, "timing.td4": 0.003},
}


@pytest.mark.parametrize("name", COMPENSATORS)
def test_sampled_response_of_a_compensated_loop_is_that_of_a_simulation(name):
    spec, w = apply(PAPER, DAMPED | COMPENSATORS[name]), 2.0 * np.pi / 1.2
    expected = simulated(spec, "plant", "x1", w, settle=60, cycles=4, rows=1000)
    found = response(spec, np.array([w]))
    np.testing.assert_allclose(found.ways["sampled"][0][:, 0], expected, rtol=1e-6)
    assert "but not in the margins" in found.left_out[0]
