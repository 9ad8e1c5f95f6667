"""The lifted loop against the exact engine."""

import numpy as np
import pytest

from rthm_analysis.lifted.commensurate import period_of
from rthm_analysis.lifted.cycle import cycle
from rthm_analysis.lifted.lifted import Lifted
from rthm_analysis.lifted.linear_part import linear_part
from rthm_analysis.lifted.matrices import linear_loop
from rthm_analysis.lifted.steps import steps
from rthm_core.engine import simulate
from rthm_core.errors import InputError
from rthm_core.physical.side import build
from rthm_core.schedule import Schedule
from rthm_core.spec import apply, shipped_spec


def lifted(spec):
    linear, _ = linear_part(spec)
    return Lifted(linear_loop(linear), period_of(linear).cycle)


def start(spec, loop):
    """Lifted state at the start of a test."""
    state = build(spec).state
    z = np.concatenate([spec.numerical.initial_position, spec.numerical.initial_velocity])
    return loop.at_rest_before(np.concatenate([state.q, state.y]), z)


def times(**seconds):
    return {f"timing.{name}": value for name, value in seconds.items()}


MOTOR_LAG = {"block": "motor", "actuator": "a1", "kind": "lag", "time_constant": 0.004}
DELAYED = {"block": "link.tau3", "kind": "extra_delay", "delay": 0.0031}
MEMORY = {"block": "plant", "dof": "x1", "kind": "fluid_memory"}
EFFECTS = {
    "effects": ["lag", "late", "water", "filter"],
    "lag": MOTOR_LAG,
    "late": DELAYED,
    "water": MEMORY | {"gain": 3.0, "frequency": 3.0, "damping_ratio": 0.4},
    "filter": {"block": "sensor.position", "dof": "x1", "kind": "lag", "time_constant": 0.002},
}
LOOPS = {
    "paper": ("paper", {}),
    "several dofs and actuators": ("three_mass", {}),
    "motor poles and a moving pulley": ("transmission", {}),
    "linear effects": ("paper", EFFECTS),
    "no delays": ("paper", times(tau1=0.0, tau2=0.0, tau3=0.0, tau4=0.0)),
    "a clock for the reference": ("paper", times(td4=0.003)),
    "references between two ticks": ("paper", times(tau3=0.0105, tau4=0.0011)),
    "delays of many hyperperiods": ("paper", times(tau1=0.0613, tau2=0.0331, tau3=0.0457, tau4=0.0999)),
    "delays of whole hyperperiods": ("paper", times(tau1=0.012, tau2=0.024, tau3=0.012, tau4=0.036)),
    "slow sampling": ("paper", times(td1=0.02, td2=0.03, td3=0.012)),
}


@pytest.mark.parametrize("name", LOOPS)
def test_a_free_run_is_a_power_of_the_monodromy(name):
    shipped, changes = LOOPS[name]
    spec = apply(shipped_spec(shipped), changes)
    loop = lifted(spec)
    period, monodromy, state = loop.cycle.hyperperiod, loop.monodromy(), start(spec, loop)
    found = simulate(spec, 40 * period, period, energies=False)
    physical = loop.loop.a1.shape[0]
    for row in range(found.t.size):
        x1 = loop.loop.position1 @ state[:physical]
        x2 = loop.loop.position2 @ state[physical : loop.moving]
        assert np.abs(x1 - found.plant_position[row]).max() < 1e-10
        assert np.abs(x2 - found.numerical_position[row]).max() < 1e-10
        state = monodromy @ state


def test_steps_are_the_matrix_exponential_for_short_and_long_intervals():
    from scipy.linalg import expm

    a, b = np.array([[0.0, 1.0], [-40.0, -0.3]]), np.array([[0.0], [7.0]])
    joint = np.zeros((3, 3))
    joint[:2] = np.hstack([a, b])
    intervals = np.array([0.0, 1e-9, 1e-3, 0.4, 5.0])
    expected = np.array([expm(joint * dt)[:2] for dt in intervals])
    np.testing.assert_allclose(steps(a, b, intervals), expected, rtol=1e-12, atol=1e-13)


def test_a_scaled_cycle_is_the_cycle_of_scaled_times():
    spec = shipped_spec("paper")
    cycle = period_of(linear_part(spec)[0]).cycle.scaled(2.5)
    again = period_of(linear_part(spec.scaled_timing(2.5))[0]).cycle
    assert cycle.hyperperiod == pytest.approx(again.hyperperiod, rel=1e-15)
    np.testing.assert_allclose(cycle.time * cycle.unit, again.time * again.unit, rtol=1e-15)
    np.testing.assert_array_equal(cycle.place, again.place)


def test_clocks_that_never_meet_get_the_nearest_periods_that_do():
    spec = apply(shipped_spec("paper"), times(td1=0.00120037123, td2=0.0117654321, td3=0.0041234567))
    cycle, error = period_of(spec)
    assert 0.0 < error < 1e-5
    for what, period in ((1, spec.timing.td2),):
        ticks = np.count_nonzero(cycle.what == what)
        assert cycle.hyperperiod / ticks == pytest.approx(period, rel=2.0 * error)


@pytest.mark.parametrize(
    ("name", "td4", "step"), [("tau1", 0.0, 400_000), ("tau2", 0.005, 1_200_000), ("tau3", 0.005, 1_000_000)]
)
def test_delays_within_a_step_have_the_cycle_of_the_longest_of_them(name, td4, step):
    schedule = Schedule(apply(shipped_spec("paper"), times(td4=td4)))
    assert schedule.delay_step(name) == step

    def events(delay_ns):
        other = schedule.copied()
        other.links[name].delay_ns = delay_ns
        found = cycle(other)
        return found.time.tolist(), found.place.tolist(), found.kept.tolist()

    for steps_long in (0, 1, 7, 40, 41):
        longest = steps_long * step
        assert events(longest) != events(longest + 1)
        for delay_ns in (longest - 1, longest - step // 2, longest - step + 1):
            assert delay_ns < 0 or events(delay_ns) == events(longest)


def test_delays_of_commands_differ_by_every_nanosecond():
    schedule = Schedule(shipped_spec("paper"))
    assert schedule.delay_step("tau3") == schedule.delay_step("tau4") == 1


def test_what_is_not_linear_is_named():
    friction = {"block": "plant", "dof": "x1", "kind": "coulomb_friction", "force": 0.1}
    bias = {"block": "sensor.position", "dof": "x1", "kind": "bias", "bias": 0.1}
    changes = {"effects": ["rub", "off"], "rub": friction, "off": bias, "actuator.pretension": [2.0]}
    linear, left_out = linear_part(apply(shipped_spec("paper"), changes))
    assert linear.effects == ()
    assert len(left_out) == 2 and "rub" in left_out[0] and "a1" in left_out[1]


def test_too_many_samples_under_way_are_refused_in_a_sentence():
    spec = apply(shipped_spec("paper"), times(tau4=3000.0))
    with pytest.raises(InputError, match="in transit at once"):
        period_of(spec)


def test_a_plant_alone_is_refused_in_a_sentence():
    with pytest.raises(InputError, match="plant alone"):
        linear_part(shipped_spec("decay"))
