"""The fast way of loops with laws on the plant against the engine that takes any loop, and against itself."""

import numpy as np
import pytest

from rthm_core.engine.nonlinear.run import nonlinear_blocks
from rthm_core.engine.simulate import simulate, simulate_any, simulate_blocks
from rthm_core.spec import apply, shipped_spec

POLES = {"actuator.motor_poles": [400.0, 2000.0]}
WAVE = {"kind": "harmonic", "amplitude": 1.0, "frequency": 2.4, "phase": 0.3}


def on(dof, kind, **parameters):
    return {"block": "plant", "dof": dof, "kind": kind, **parameters}


RUB = on("x1", "coulomb_friction", force=0.05)
HOLD = on("x1", "coulomb_friction", force=0.6)
STRIBECK = on("x1", "stribeck_friction", coulomb_force=0.05, static_force=0.1, stribeck_velocity=0.05)
CUBIC = on("x1", "cubic_stiffness", coefficient=8.0)
DRAG = on("x1", "quadratic_drag", coefficient=0.3)
STOP = on("x1", "end_stop", position=0.2, stiffness=300.0, damping=2.0)
HYSTERESIS = on("x1", "bouc_wen", alpha=1.0, A=5.0, beta=2.0, gamma=1.0, n=1.5)
PLAY = on("x1", "clearance", gap=0.1, stiffness=20.0)
HARDENING = {"block": "wire", "actuator": "a1", "kind": "hardening", "coefficient": 100.0}
SLACK = {"block": "wire", "actuator": "a1", "kind": "slack", "pretension": 0.5}
SHAKY = {"block": "link.tau4", "kind": "jitter", "std": 0.001}
CASES = {
    "friction": [RUB],
    "stick and slip": [HOLD, {"load.plant": {"dof": "x1", **WAVE}}],
    "friction behind motor poles": [RUB, POLES],
    "friction and jitter": [RUB, SHAKY],
    "friction and noise": [RUB, {"noise.position": 1e-4}],
    "Stribeck friction": [STRIBECK],
    "smooth": [CUBIC, DRAG],
    "friction and a spring": [HOLD, CUBIC],
    "end stop": [STOP],
    "play": [PLAY],
    "hysteresis": [HYSTERESIS],
    "wire that hardens": [HARDENING],
    "wire that hardens behind motor poles, and friction": [HARDENING, RUB, POLES],
    "wire that hardens, and jitter": [HARDENING, SHAKY],
}


def changed(*parts, name="paper"):
    """Shipped spec with effects, which have a block, and with other changes."""
    effects = {f"e{i}": part for i, part in enumerate(parts) if "block" in part}
    changes = {key: value for part in parts if "block" not in part for key, value in part.items()}
    return apply(shipped_spec(name), changes | {"effects": list(effects)} | effects)


@pytest.mark.parametrize("case", CASES)
def test_fast_way_agrees_with_the_engine_for_any_loop(case):
    spec = changed(*CASES[case])
    assert nonlinear_blocks(spec, 1_000_000, 1_000_000, energies=False) is not None
    fast, counted = (simulate(spec, 8.0, 0.0017, energies=counting) for counting in (False, True))
    slow = simulate_any(spec, 8_000_000_000, 1_700_000)
    for name in ("plant_position", "numerical_position"):
        assert np.abs(getattr(fast, name) - getattr(slow, name)).max() < 1e-9
        assert np.abs(getattr(fast, name) - getattr(counted, name)).max() < 1e-10
    for name in ("plant_velocity", "numerical_velocity", "force_reference", "actuator_force"):
        assert np.abs(getattr(fast, name) - getattr(slow, name)).max() < 1e-7
    for term, work in slow.energies.items():
        assert np.abs(counted.energies[term] - work).max() < 1e-8, term
    assert np.abs(counted.balance_error).max() < 1e-11


@pytest.mark.parametrize("case", CASES)
def test_rows_leave_the_motion_as_it_is(case):
    spec = changed(*CASES[case])
    found, refined = (simulate(spec, 20.0, sample, energies=False) for sample in (0.0012, 0.00012))
    assert np.abs(found.plant_position - refined.plant_position[::10]).max() < 1e-9


def test_two_dofs_stick_and_slip_like_in_the_engine_for_any_loop():
    dofs = shipped_spec("three_mass").plant.dofs
    rubbing = [on(dof, "coulomb_friction", force=0.2 + 0.3 * i) for i, dof in enumerate(dofs)]
    spec = changed(*rubbing, name="three_mass")
    fast, slow = simulate(spec, 8.0, 0.01), simulate_any(spec, 8_000_000_000, 10_000_000)
    assert np.abs(fast.plant_position - slow.plant_position).max() < 1e-9
    still = np.abs(fast.plant_velocity) == 0.0
    assert still.any(axis=0).all() and not still.all(axis=0).any()
    assert np.abs(fast.balance_error).max() < 1e-11


@pytest.mark.parametrize("case", ["friction", "friction and jitter"])
@pytest.mark.parametrize("energies", [False, True])
def test_blocks_joined_are_the_whole(case, energies):
    spec = changed(*CASES[case])
    whole = simulate(spec, 25.0, 0.0013, energies=energies)
    blocks = list(simulate_blocks(spec, 25.0, 0.0013, energies=energies))
    assert len(blocks) > 1
    joined = np.concatenate([block.plant_position for block in blocks])
    assert np.abs(joined - whole.plant_position).max() < 1e-12
    for term, work in whole.energies.items():
        assert np.abs(np.concatenate([block.energies[term] for block in blocks]) - work).max() < 1e-12


def test_a_wire_with_a_kink_takes_the_other_way():
    assert nonlinear_blocks(changed(SLACK, RUB), 1_000_000, 1_000_000, energies=False) is None


def test_a_row_where_a_command_arrives_has_the_force_that_it_makes():
    spec = changed(HARDENING, {"timing.tau4": 0.0108})  # commands arrive at rows
    fast, slow = simulate(spec, 2.0, 0.0012), simulate_any(spec, 2_000_000_000, 1_200_000)
    assert np.abs(np.diff(slow.actuator_force, axis=0)).max() > 0.05
    assert np.abs(fast.actuator_force - slow.actuator_force).max() < 1e-8
