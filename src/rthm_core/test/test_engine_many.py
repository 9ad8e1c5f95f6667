"""Loops side by side against the same loops one by one, and the systems without a loop."""

import numpy as np
import pytest

from rthm_core.engine import simulate, simulate_blocks, simulate_many
from rthm_core.errors import InputError
from rthm_core.exponential import exponentials
from rthm_core.spec import apply, shipped_spec

SIGNALS = (
    "plant_position",
    "plant_velocity",
    "numerical_position",
    "numerical_velocity",
    "force_reference",
    "actuator_force",
)


def draws(name, count, **entries):
    """Values of some entries of a shipped spec, each scaled by up to a fifth."""
    chance = np.random.default_rng(5)
    spec = shipped_spec(name)
    values = {}
    for key in entries["keys"]:
        section, entry = key.split(".")
        given = np.array(getattr(getattr(spec, section), entry))
        values[key] = given * chance.uniform(0.8, 1.2, (count, 1))
    return spec, values


def test_loops_side_by_side_move_like_each_alone():
    keys = ("plant.mass", "plant.damping", "numerical.stiffness", "interface.stiffness", "actuator.stiffness")
    spec, values = draws("three_mass", 70, keys=keys)
    together = simulate_many(spec, values, 6.0, 0.01)
    for i in (0, 63, 64, 69):
        alone = simulate(
            apply(spec, {k: v[i].tolist() for k, v in values.items()}), 6.0, 0.01, energies=False
        )
        for name in SIGNALS:
            assert np.abs(getattr(together, name)[i] - getattr(alone, name)).max() < 1e-12


@pytest.mark.parametrize(
    "times",
    [{"tau4": 0.05, "tau2": 0.03}, {"td1": 0.0007, "td2": 0.0035}, {"td1": 0.03, "td2": 0.005, "td3": 0.01}],
    ids=["long delays", "many samples", "few samples"],
)
def test_loops_side_by_side_find_their_samples_whatever_the_clocks(times):
    spec = apply(shipped_spec("paper"), {f"timing.{name}": time for name, time in times.items()})
    mass = np.linspace(1.0, 1.5, 9)[:, None]
    together = simulate_many(spec, {"plant.mass": mass}, 3.0, 0.01)
    for i in (0, 8):
        alone = simulate(apply(spec, {"plant.mass": mass[i].tolist()}), 3.0, 0.01, energies=False)
        for name in SIGNALS:
            scale = max(1.0, np.abs(getattr(alone, name)).max())
            assert np.abs(getattr(together, name)[i] - getattr(alone, name)).max() < 1e-12 * scale


def with_more_dofs(spec, more):
    """The spec with free masses on springs beside those of the plant, so that its state is long."""

    def grown(values, own):
        size = len(spec.plant.dofs)
        matrix = np.diag(np.full(size + more, own))
        matrix[:size, :size] = np.reshape(values, (size, size))
        return matrix.ravel().tolist()

    return apply(
        spec,
        {
            "plant.dofs": [*spec.plant.dofs, *(f"free{i}" for i in range(more))],
            "plant.mass": grown(spec.plant.mass, 1.0),
            "plant.damping": grown(spec.plant.damping, 0.1),
            "plant.stiffness": grown(spec.plant.stiffness, 20.0),
            "plant.initial_position": [*spec.plant.initial_position, *[0.1] * more],
            "plant.initial_velocity": [*spec.plant.initial_velocity, *[0.0] * more],
        },
    )


def test_loops_too_long_for_registers_move_like_each_alone():
    spec = with_more_dofs(shipped_spec("three_mass"), 2)
    k_tot = np.array(spec.actuator.stiffness) * np.linspace(0.9, 1.1, 70)[:, None]
    together = simulate_many(spec, {"actuator.stiffness": k_tot}, 2.0, 0.01)
    for i in (0, 69):
        alone = simulate(apply(spec, {"actuator.stiffness": k_tot[i].tolist()}), 2.0, 0.01, energies=False)
        for name in SIGNALS:
            assert np.abs(getattr(together, name)[i] - getattr(alone, name)).max() < 1e-12


DELAYS = ("timing.tau1", "timing.tau2", "timing.tau3", "timing.tau4")
CLOCKS = ("timing.td1", "timing.td2", "timing.td3")


@pytest.mark.parametrize("name", ["paper", pytest.param("three_mass", marks=pytest.mark.long)])
@pytest.mark.parametrize("keys", [DELAYS, CLOCKS, (*DELAYS, *CLOCKS)], ids=["delays", "clocks", "both"])
@pytest.mark.parametrize("sample", [0.0034, 0.37], ids=["often", "seldom"])
def test_loops_with_times_of_their_own_move_like_each_alone(name, keys, sample):
    chance, spec = np.random.default_rng(7), shipped_spec(name)
    values = {
        key: np.round(getattr(spec.timing, key[-4:].strip(".")) * chance.uniform(0.5, 1.5, 4), 6)
        for key in keys
    }
    values["plant.mass"] = np.array(spec.plant.mass) * chance.uniform(0.9, 1.2, (4, 1))
    together = simulate_many(spec, values, 5.0, sample)
    for i in range(4):
        own = {key: one[i].tolist() for key, one in values.items()}
        alone = simulate(apply(spec, own), 5.0, sample, energies=False)
        for signal in SIGNALS:
            assert np.abs(getattr(together, signal)[i] - getattr(alone, signal)).max() < 1e-11


def test_delays_of_zero_pass_at_once_in_a_loop_with_times_of_its_own():
    spec = shipped_spec("paper")
    values = {key: [0.0, 0.004] for key in DELAYS[:3]}
    together = simulate_many(spec, values, 3.0, 0.01)
    for i in range(2):
        alone = simulate(apply(spec, {key: one[i] for key, one in values.items()}), 3.0, 0.01, energies=False)
        for signal in SIGNALS:
            assert np.abs(getattr(together, signal)[i] - getattr(alone, signal)).max() < 1e-12


def test_loops_that_no_kernel_takes_together_run_one_after_the_other():
    spec = shipped_spec("paper")
    together = simulate_many(spec, {"timing.tau4": [0.0, 0.006]}, 2.0, 0.01)
    slower = simulate(apply(spec, {"timing.tau4": 0.006}), 2.0, 0.01, energies=False)
    assert np.array_equal(together.plant_position[1], slower.plant_position)


def test_entries_of_different_lengths_are_refused():
    with pytest.raises(InputError, match="same number of loops"):
        simulate_many(shipped_spec("paper"), {"plant.mass": [1.0, 2.0], "plant.damping": [0.1]}, 1.0)


def test_a_loop_that_is_not_allowed_is_refused():
    with pytest.raises(InputError, match=r"plant\.mass"):
        simulate_many(shipped_spec("paper"), {"plant.mass": [1.0, -2.0]}, 1.0)


def test_exponentials_of_slow_modes_are_exact_beside_fast_ones():
    lengths = np.array([0, 400_000, 12_000_000])
    found = exponentials(np.diag([-0.01, -2000.0]), lengths)
    for step, t in zip(found, lengths * 1e-9, strict=True):
        assert step[0, 0] == pytest.approx(np.exp(-0.01 * t), rel=3e-16)
        assert step[1, 1] == pytest.approx(np.exp(-2000.0 * t), rel=1e-12)


@pytest.mark.parametrize("system", ["ideal", "taylor"])
def test_linear_systems_without_a_loop_swing_like_their_modes(system):
    from rthm_core.engine.coupled.body import coupled_body

    spec = shipped_spec("paper")
    body = coupled_body(spec, system)
    inverse, n = np.linalg.inv(body.mass), body.dofs
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ body.stiffness, -inverse @ body.damping]])
    values, vectors = np.linalg.eig(a)
    part = np.linalg.solve(vectors, np.concatenate([body.position, body.velocity]).astype(complex))
    found = simulate(spec, 20.0, 0.01, system, energies=False)
    exact = (vectors @ (part[:, None] * np.exp(np.outer(values, found.t)))).real
    assert np.abs(found.plant_position[:, 0] - exact[0]).max() < 1e-12
    assert np.abs(found.numerical_position[:, 0] - exact[1]).max() < 1e-12


SHAKY = {"effects": ["shaky"], "shaky": {"block": "link.tau4", "kind": "jitter", "std": 0.001}}


@pytest.mark.parametrize("changes", [{}, {"noise.position": 1e-4}, SHAKY], ids=["plain", "noise", "jitter"])
@pytest.mark.parametrize("energies", [False, True])
def test_blocks_joined_are_the_whole(changes, energies):
    spec = apply(shipped_spec("paper"), changes)
    whole = simulate(spec, 25.0, 0.0013, energies=energies)
    blocks = list(simulate_blocks(spec, 25.0, 0.0013, energies=energies))
    assert len(blocks) > 1
    for name in ("t", *SIGNALS):
        joined = np.concatenate([getattr(block, name) for block in blocks])
        assert joined.shape == getattr(whole, name).shape
        assert np.abs(joined - getattr(whole, name)).max() < 1e-12
    for term, work in whole.energies.items():
        assert np.abs(np.concatenate([block.energies[term] for block in blocks]) - work).max() < 1e-12


def test_no_block_is_empty_where_the_last_instant_has_no_row() -> None:
    spec = apply(shipped_spec(), {"actuator.compensator": "polynomial"})
    blocks = list(simulate_blocks(spec, 20.0, 0.0012, energies=False))
    assert min(block.t.size for block in blocks) > 0
    assert sum(block.t.size for block in blocks) == simulate(spec, 20.0, 0.0012, energies=False).t.size
