"""Compensators: what they predict exactly, and what they leave of the loop's error."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rthm_core.compensation import compensation, first_parts, mean_age
from rthm_core.controller import Controller
from rthm_core.engine import simulate
from rthm_core.errors import InputError
from rthm_core.schedule import Schedule
from rthm_core.spec import apply, shipped_spec
from rthm_core.substructure import interface

PAPER = shipped_spec("paper")
MS = 1_000_000


def compensating(name, spec=PAPER, **changes):
    return apply(spec, {"actuator.compensator": name} | {f"actuator.{k}": v for k, v in changes.items()})


def steps(count):
    return st.lists(st.integers(500_000, 30 * MS), min_size=count, max_size=count)


@settings(max_examples=40, deadline=None)
@given(
    order=st.integers(1, 4),
    states=steps(5),
    references=steps(5),
    one=st.lists(st.floats(-1.0, 1.0), min_size=5, max_size=5),
    two=st.lists(st.floats(-1.0, 1.0), min_size=5, max_size=5),
)
def test_a_polynomial_motion_is_predicted_exactly_at_irregular_stamps(order, states, references, one, two):
    """Motion in units of 50 ms, so that its terms are of one size; F_d as the numerical side makes it."""
    spec = compensating("polynomial", compensator_order=order)
    age, sides = compensation(spec).motion_age, interface(spec)
    x1, x2 = (np.polynomial.Polynomial(c[: order + 1], [0.0, 0.05], [0.0, 1.0]) for c in (one, two))
    v1, v2 = x1.deriv(), x2.deriv()
    controller = Controller(spec)
    for stamp in np.cumsum(states):
        controller.latch_state(stamp, [x1(stamp * 1e-9)], [v1(stamp * 1e-9)])
    for stamp in np.cumsum(references):
        then, t = stamp * 1e-9 - age, stamp * 1e-9
        controller.latch_force(stamp, sides.force(x1(then), v1(then), x2(t), v2(t)))
    now = max(sum(states), sum(references)) + 4 * MS
    acts = (now // (4 * MS)) * 0.004 + 0.002 + 0.010
    u_d = controller.command(now)
    expected = sides.force(x1(acts), v1(acts), x2(acts), v2(acts))
    size = 1e-9 * max(1.0, abs(x1(acts)), np.abs(expected).max()) * (200.0 ** (order - 1))
    np.testing.assert_allclose(controller.force, expected, atol=size)
    np.testing.assert_allclose(u_d, x1(acts) + expected / spec.k_tot[0], atol=size)


def test_the_linear_terms_predict_uniform_motion_at_the_mean_age_of_every_path():
    spec, sides = compensating("taylor"), interface(PAPER)
    x1, v1, x2, v2 = 0.1, 0.7, -0.2, 0.3
    controller = Controller(spec)
    for tick in range(3):
        at, then = tick * 0.012, tick * 0.012 - 0.0084
        controller.latch_state(tick * 12 * MS, [x1 + v1 * at], [v1])
        controller.latch_force(tick * 12 * MS, sides.force(x1 + v1 * then, v1, x2 + v2 * at, v2))
    u_d = controller.command(28 * MS)
    position, at_wire = x1 + v1 * (0.024 + 0.0164), 0.024 + 0.028
    force = sides.force(x1 + v1 * at_wire, v1, x2 + v2 * at_wire, v2)
    np.testing.assert_allclose(controller.force, force, rtol=1e-12)
    np.testing.assert_allclose(u_d, position + force / 40.0, rtol=1e-12)


def test_mean_ages_of_the_paper_are_those_of_its_in_phase_clocks():
    how = compensation(PAPER)
    assert how.position_horizon == pytest.approx(0.0164)
    assert how.motion_age + how.force_horizon == pytest.approx(0.0364)
    assert how.motion_age + 0.5 * PAPER.timing.td2 == pytest.approx(0.0144)


@settings(max_examples=40, deadline=None)
@given(
    td1=st.integers(5, 60).map(lambda n: n * 1e-4),
    td3=st.integers(5, 60).map(lambda n: n * 1e-4),
    tau1=st.integers(0, 300).map(lambda n: n * 1e-4),
)
def test_the_mean_age_is_that_of_the_schedule(td1, td3, tau1):
    spec = apply(PAPER, {"timing.td1": td1, "timing.td3": td3, "timing.tau1": tau1, "timing.td2": td1})
    commands = Schedule(spec).commands(10**9, 10**9 + spec.hyperperiod_ns)
    regular = commands.time % spec.timing.ns("td3") == 0
    ages = commands.time[regular] - commands.state[regular] * spec.timing.ns("td1")
    assert mean_age(spec.timing, "tau1", "td1", "td3") == pytest.approx(ages.mean() * 1e-9, abs=1e-12)


@cache
def energies(name, shipped="paper"):
    found = simulate(compensating(name, shipped_spec(shipped)), 20.0, 0.012)
    assert np.abs(found.balance_error).max() < 1e-9
    return {term: work[-1] for term, work in found.energies.items()}


@pytest.mark.parametrize("name", ["taylor", "polynomial"])
@pytest.mark.parametrize("shipped", ["paper", "three_mass"])
def test_prediction_takes_nearly_all_of_the_actuators_energy_error_away(name, shipped):
    with_it, without = energies(name, shipped), energies("none", shipped)
    for term in ("E_fx", "E_ff"):
        assert abs(with_it[term]) < 0.02 * abs(without[term])


def test_higher_orders_leave_less():
    left = [abs(energies_of_order(order)) for order in (2, 3, 4)]
    assert left == sorted(left, reverse=True)
    assert left[2] < 1e-4 < left[0]


def energies_of_order(order):
    spec = compensating("polynomial", compensator_order=order)
    return simulate(spec, 20.0, 0.012).energies["E_fx"][-1]


def test_the_horizon_is_delay_and_motor_poles_unless_it_is_given():
    assert compensation(PAPER).way == 0.010
    with_poles = apply(PAPER, {"actuator.motor_poles": [400.0, 2000.0]})
    assert compensation(with_poles).way == pytest.approx(0.013)
    given_one = apply(PAPER, {"actuator.compensator_horizon": 0.007})
    assert compensation(given_one).position_horizon == pytest.approx(0.0134)


def test_a_horizon_that_is_wrong_leaves_its_share_of_the_damping():
    """Half the motor's delay not compensated: k_tot times 5 ms instead of 16.4 ms."""
    half = simulate(compensating("taylor", compensator_horizon=0.005), 2.0, 0.004).energies["E_fx"][-1]
    assert energies("taylor")["E_fx"] > half > energies("none")["E_fx"]


@pytest.mark.parametrize("name", ["none", "taylor", "polynomial"])
def test_the_first_command_is_what_the_controller_would_always_have_given(name):
    wrong = {"block": "controller", "kind": "wrong_parameter", "name": "actuator.stiffness", "value": 44.0}
    moving = {"plant.initial_velocity": [0.3], "numerical.initial_position": [0.1], "effects": ["wrong"]}
    spec = apply(compensating(name), moving | {"wrong": wrong})
    np.testing.assert_allclose(sum(first_parts(spec)), Controller(spec).command(0), rtol=1e-13)


@pytest.mark.parametrize("name", ["ats", "model", "inverse", "passivity"])
def test_a_compensator_that_is_not_there_is_refused_in_one_sentence(name):
    with pytest.raises(InputError, match="allowed is one of none, taylor, polynomial; choose one of them"):
        Controller(compensating(name))
