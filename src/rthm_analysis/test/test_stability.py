"""Stability against long simulations, closed forms, and the figures of the paper."""

import numpy as np
import pytest

from rthm_analysis.lifted.commensurate import period_of
from rthm_analysis.lifted.eigen import write_moduli
from rthm_analysis.lifted.linear_part import linear_part
from rthm_analysis.lifted.matrices import linear_loop
from rthm_analysis.lifted.radii import spectral_radii, stacked
from rthm_analysis.stability import spectral_radius, stability
from rthm_analysis.stability.limits import delay_limit, k_tot_limit, scale_limit
from rthm_analysis.stability.map import stability_map
from rthm_analysis.stability.picture import draw
from rthm_analysis.stability.rates import growth_rates
from rthm_analysis.stability.search import scan
from rthm_analysis.sweep.ranges import given_range
from rthm_core.engine import simulate
from rthm_core.spec import apply, shipped_spec


@pytest.fixture(scope="module")
def paper():
    return stability(shipped_spec("paper"))


def parts(spec):
    linear, _ = linear_part(spec)
    return linear, linear_loop(linear), period_of(linear).cycle


def growth(spec, duration):
    """Growth rate of the energy's root between two halves of a long free run, 1/s."""
    found = simulate(spec, duration, duration / 20_000, energies=False)
    k = spec.k_tot[0] + spec.plant.stiffness[0]
    size = np.hypot(found.plant_position[:, 0] * np.sqrt(k), found.plant_velocity[:, 0])
    middle = size.size // 2
    span = size.size // 10
    early, late = (np.log(np.sqrt(np.mean(size[at : at + span] ** 2))) for at in (middle, size.size - span))
    return (late - early) / (found.t[-span] - found.t[middle])


def fitted_pair(t, x):
    """Exponent of the two slowest conjugate pairs in a free decay, from its samples (Prony)."""
    order = 4
    rows = np.array([x[i : i + order] for i in range(x.size - order)])
    ahead = np.linalg.lstsq(rows, x[order:], rcond=None)[0]
    return np.log(np.roots([1.0, *-ahead[::-1]]).astype(complex)) / (t[1] - t[0])


def test_modes_are_those_of_a_long_decay(paper):
    found = simulate(shipped_spec("paper"), 40.0, 0.12, energies=False)
    seen = fitted_pair(found.t[20:], found.plant_position[20:, 0])
    for mode in paper.modes[:2]:
        nearest = seen[np.argmin(np.abs(seen - mode.exponent))]
        assert nearest.real == pytest.approx(mode.exponent.real, abs=1e-6)
        assert nearest.imag == pytest.approx(mode.exponent.imag, abs=1e-6)


def test_the_paper_loses_stability_when_all_delays_are_about_21_times_longer(paper):
    assert paper.stable
    assert paper.as_dict()["critical_scale"] == pytest.approx(21.17, abs=0.01)


@pytest.mark.parametrize("beside", [0.98, 1.02])
def test_a_simulation_fades_below_the_critical_scale_and_grows_above_it(paper, beside):
    scale = paper.limits["scale"].critical_scale * beside
    assert (growth(shipped_spec("paper").scaled_timing(scale), 400.0) > 0.0) == (beside > 1.0)


@pytest.mark.parametrize("name", ["tau1", "tau2", "tau3", "tau4", "td2"])
@pytest.mark.parametrize("beside", [0.95, 1.05])
def test_a_simulation_changes_side_at_the_limit_of_each_delay(paper, name, beside):
    value = paper.limits[name].critical_value * beside
    spec = apply(shipped_spec("paper"), {f"timing.{name}": value})
    assert (growth(spec, 150.0) > 0.0) == (beside > 1.0)


def test_k_tot_has_a_lower_and_an_upper_limit(paper):
    limits = paper.as_dict()["k_tot"]
    for value, unstable_beyond in ((limits["lower"], 0.9), (limits["upper"], 1.1)):
        for beside in (0.9, 1.1):
            spec = apply(shipped_spec("paper"), {"actuator.stiffness": [value * beside]})
            assert (spectral_radius(spec) > 1.0) == (beside == unstable_beyond)
    slack = apply(shipped_spec("paper"), {"actuator.stiffness": [0.9 * limits["lower"]]})
    assert growth(slack, 200.0) > 0.0


def test_a_loop_without_any_damping_is_damped_by_its_delays():
    still = {f"timing.{name}": 0.0 for name in ("tau2", "tau3", "tau4")}
    undamped = {"plant.damping": [0.0], "numerical.damping": [0.0], "interface.damping": [0.0]}
    spec = apply(shipped_spec("paper"), still | undamped | {"timing.tau1": 0.001})
    assert spectral_radius(spec) < 1.0


FED_BACK = {
    "plant.mass": [1.0],
    "plant.damping": [0.05],
    "plant.stiffness": [4.0],
    "interface.stiffness": [0.0],
    "interface.damping": [0.0],
    "actuator.stiffness": [0.3],
    **{f"timing.{name}": 0.02 for name in ("td1", "td2", "td3")},
    **{f"timing.{name}": 0.0 for name in ("tau1", "tau2", "tau3")},
    "timing.tau4": 0.2,
}
"""A mass on a spring with delayed feedback of its position: stable by turns as the delay grows."""


def delayed_oscillator_radius(scale):
    """The same loop, written down directly: x(k+1) = Phi x(k) + Gamma x1(k - 10)."""
    from scipy.linalg import expm

    dt, behind = 0.02 * scale, 10
    generator = np.array([[0.0, 1.0, 0.0], [-4.3, -0.05, 0.3], [0.0, 0.0, 0.0]])
    step = expm(generator * dt)
    matrix = np.zeros((2 + behind, 2 + behind))
    matrix[:2, :2], matrix[:2, -1] = step[:2, :2], step[:2, 2]
    matrix[2, 0] = 1.0
    matrix[3:, 2:-1] = np.eye(behind - 1)
    return np.abs(np.linalg.eigvals(matrix)).max()


def test_every_crossing_of_a_loop_that_is_stable_by_turns_is_found():
    spec, loop, cycle = parts(apply(shipped_spec("paper"), FED_BACK))
    found = scale_limit(spec, loop, cycle).scan.crossings
    scales = np.linspace(0.0, 99.9, 10_001)[1:]
    side = np.array([delayed_oscillator_radius(s) > 1.0 for s in scales])
    expected = np.flatnonzero(side[1:] != side[:-1])
    near = [one for one in found if one.value < scales[-1]]
    assert len(near) == expected.size > 8
    for one, at in zip(near, expected, strict=True):
        assert scales[at] <= one.value <= scales[at + 1]
        assert one.lost == side[at + 1]


def test_a_pair_of_crossings_between_two_points_of_the_first_scan_is_found():
    def rates(x):
        return np.stack([0.003 - np.abs(np.sin(x) - 0.995), np.full(x.size, -1.0)], axis=1)

    inside = [np.arcsin(0.992), np.arcsin(0.998), np.pi - np.arcsin(0.998), np.pi - np.arcsin(0.992)]
    found = scan(rates, np.linspace(0.0, 3.0, 31), 1e-12).crossings
    np.testing.assert_allclose([one.value for one in found], inside, atol=1e-10)
    assert [one.lost for one in found] == [True, False, True, False]


def test_a_delay_between_two_samples_changes_nothing():
    """tau1 acts only through which sample is the newest: a step of gcd(Td1, Td3)."""
    radii = [
        spectral_radius(apply(shipped_spec("paper"), {"timing.tau1": t})) for t in (0.0037, 0.0039, 0.0041)
    ]
    assert radii[0] == radii[1] != radii[2]


def test_clocks_that_never_meet_grow_as_a_long_simulation_does():
    times = {"timing.td1": 0.0371234, "timing.td2": 0.1012345, "timing.td3": 0.0798765, "timing.tau4": 0.12}
    spec = apply(shipped_spec("paper"), times)
    linear, loop, cycle = parts(spec)
    assert period_of(linear).error > 0.0
    expected = growth_rates(loop, cycle)[0]
    assert growth(spec, 100.0) == pytest.approx(expected, rel=0.02)


def test_a_mode_keeps_its_frequency_when_the_hyperperiod_is_longer_than_it():
    """Eigenvalues over seconds leave the frequency open; the motion does not."""
    spec = apply(shipped_spec("paper"), {"timing.td1": 0.0012003})
    result = stability(spec, limits=False)
    assert result.hyperperiod > 4.0
    assert result.modes[0].frequency == pytest.approx(2.416, abs=0.002)
    assert result.modes[1].frequency == pytest.approx(4.148, abs=0.002)


def test_a_transmission_has_limits_of_k_tot_too():
    spec, _, cycle = parts(shipped_spec("transmission"))
    lower, upper = k_tot_limit(spec, cycle).scan.around(1.0)
    for factor, beyond in ((lower, 0.99), (upper, 1.01)):
        k = factor * beyond * spec.k_tot[0]
        assert spectral_radius(apply(spec, {"actuator.stiffness": [k]})) > 1.0


def test_a_delay_of_zero_has_a_critical_value_but_no_critical_scale():
    spec, loop, _ = parts(apply(shipped_spec("paper"), {"timing.tau4": 0.0}))
    limit = delay_limit(spec, loop, "tau4")
    assert limit.critical_scale is None
    assert limit.critical_value > 0.1


@pytest.mark.parametrize("block", ["link.tau4", "motor"])
def test_a_delay_shorter_than_the_specs_leaves_the_limit_where_it_is(block):
    spec = shipped_spec("paper")
    early = {"block": block, "kind": "extra_delay", "delay": -0.002}
    early |= {"actuator": "a1"} if block == "motor" else {}
    same = apply(spec, {"timing.tau4": 0.012, "effects": ["early"], "early": early})
    assert spectral_radius(same) == pytest.approx(spectral_radius(spec), abs=1e-12)
    limits = [delay_limit(one, parts(one)[1], "tau4").critical_value for one in (spec, same)]
    assert limits[1] - limits[0] == pytest.approx(0.002, abs=1e-6)


def test_many_loops_at_once_have_the_radii_that_each_has_alone():
    spec, loop, cycle = parts(shipped_spec("three_mass"))
    softer = linear_loop(apply(spec, {"actuator.stiffness": [11.0, 19.0]}))
    factors = np.array([0.5, 1.0, 20.0, 90.0])
    for one in (loop, softer):
        found = spectral_radii(stacked([one] * 4), cycle, cycle.unit * factors)
        alone = [growth_rates(one, cycle.scaled(f))[0] * cycle.hyperperiod * f for f in factors]
        np.testing.assert_allclose(np.log(found), alone, atol=1e-12)


@pytest.mark.parametrize("size", [1, 2, 3, 7, 20])
def test_moduli_are_those_of_lapack(size):
    random = np.random.default_rng(size)
    for _ in range(100):
        matrix = random.normal(size=(size, size))
        found = np.empty(size)
        write_moduli(matrix.copy(), found)
        expected = np.abs(np.linalg.eigvals(matrix))
        np.testing.assert_allclose(np.sort(found), np.sort(expected), rtol=1e-8)


def test_a_map_has_the_growth_rate_of_every_loop_alone():
    ranges = given_range("timing.tau4=0.002:0.3:3"), given_range("actuator.stiffness=10:400:2:log")
    found = stability_map(shipped_spec("paper"), ranges).growth_rate
    for i, tau4 in enumerate(ranges[0].values):
        for j, k in enumerate(ranges[1].values):
            changes = {"timing.tau4": tau4, "actuator.stiffness": k}
            _, loop, cycle = parts(apply(shipped_spec("paper"), changes))
            assert found[i, j] == pytest.approx(growth_rates(loop, cycle)[0], rel=1e-9)


def test_a_map_is_a_picture_with_its_edge(tmp_path):
    ranges = given_range("timing.scale=1:30:12"), given_range("actuator.stiffness=2:400:12:log")
    found = stability_map(shipped_spec("paper"), ranges)
    assert found.growth_rate.max() > 0.0 > found.growth_rate.min()
    draw(found, (1.0, 40.0), tmp_path / "map.svg")
    assert (tmp_path / "map.svg").read_text().count("<path") > 20


@pytest.mark.parametrize("compensator", ["taylor", "polynomial"])
def test_a_compensated_loop_has_the_modes_of_its_long_decay(compensator):
    spec = apply(shipped_spec("paper"), {"actuator.compensator": compensator})
    mode = stability(spec, limits=False).modes[0]
    found = simulate(spec, 40.0, 0.12, energies=False)
    seen = fitted_pair(found.t[20:], found.plant_position[20:, 0])
    assert np.abs(seen - mode.exponent).min() < 1e-6


def test_a_compensator_that_knows_the_scaled_delays_is_scaled_exactly():
    """Twice all times, in the spec and in the unit of the cycle: only ns are rounded."""
    spec, loop, cycle = parts(apply(shipped_spec("paper"), {"actuator.compensator": "taylor"}))
    twice, _, twice_cycle = parts(spec.scaled_timing(2.0))
    expected = growth_rates(linear_loop(twice), twice_cycle)
    found = growth_rates(loop, cycle.scaled(2.0), cycle.unit)
    np.testing.assert_allclose(found[:4], expected[:4], rtol=1e-9)


@pytest.mark.parametrize("compensator", ["taylor", "polynomial"])
def test_prediction_leaves_only_the_delay_that_the_numerical_substructure_feels(compensator):
    """14.4 ms of z1 in the force on mass 2 (26), which no controller can take out."""
    damping, stiffness = np.array([[0.15, -0.1], [-0.1, 0.15]]), np.array([[18.0, -6.0], [-6.0, 12.0]])
    felt = 0.0144 * np.array([[0.0, 0.0], [1.0, 0.0]])
    inverse_mass = np.linalg.inv(np.diag([1.2, 1.5]) + 0.1 * felt)
    below = np.hstack([-inverse_mass @ stiffness, -inverse_mass @ (damping + 6.0 * felt)])
    poles = np.linalg.eigvals(np.vstack([np.eye(4)[2:], below]))
    slowest = poles[np.argmin(np.abs(poles))]
    spec = apply(shipped_spec("paper"), {"actuator.compensator": compensator})
    left = stability(spec, limits=False).modes[0].damping_ratio
    assert left == pytest.approx(-slowest.real / abs(slowest), rel=0.02)
