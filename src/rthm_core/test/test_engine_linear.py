"""The fast way of linear loops against the engine that takes any loop."""

import numpy as np
import pytest

from rthm_core.engine.linear.run import linear_blocks
from rthm_core.engine.simulate import simulate, simulate_any, simulate_blocks
from rthm_core.spec import apply, shipped_spec

WAVE = {"kind": "harmonic", "amplitude": 1.0, "frequency": 2.4, "phase": 0.3}
MANY = {"kind": "multisine", "rms": 0.5, "low": 1.0, "high": 9.0, "count": 7, "seed": 3}
STAGE = {"block": "motor", "actuator": "a1", "kind": "second_order", "frequency": 300.0, "damping_ratio": 0.7}
BRANCH = {"block": "plant", "dof": "x1", "kind": "maxwell_branch", "stiffness": 5.0, "damping": 1.0}
SLOW = {"block": "sensor.position", "dof": "x1", "kind": "lag", "time_constant": 0.004}
SHIFT = {"block": "sensor.velocity", "dof": "x1", "kind": "scale", "scale": 1.1}
LOOSE = {"block": "link.tau2", "kind": "loss", "fraction": 0.2}
SHAKY = {"block": "link.tau4", "kind": "jitter", "std": 0.002}
WRONG = {"block": "controller", "kind": "wrong_parameter", "name": "actuator.stiffness", "value": 45.0}
NOISE = {"noise.position": 1e-4, "noise.velocity": 2e-3, "noise.seed": 4}
LATE = {"block": "link.tau1", "kind": "jitter", "std": 0.003}
TREMBLING = {"block": "link.tau4", "kind": "jitter", "std": 1e-9}
AT_ONCE = {f"timing.{name}": 0.0 for name in ("tau1", "tau2", "tau3", "tau4")}

CHAIN = np.diag(np.full(7, 24.0)) - 6.0 * (np.eye(7, k=1) + np.eye(7, k=-1))
MASSES = {
    "plant.dofs": [f"p{i}" for i in range(7)],
    "plant.mass": np.eye(7).ravel().tolist(),
    "plant.damping": (0.01 * CHAIN).ravel().tolist(),
    "plant.stiffness": CHAIN.ravel().tolist(),
    "plant.initial_position": [0.1] + [0.0] * 6,
    "plant.initial_velocity": [0.0] * 7,
    "interface.plant_dof": ["p0", "p3"],
    "interface.numerical_dof": ["x2", "x2"],
    "interface.stiffness": [6.0, 3.0],
    "interface.damping": [0.1, 0.0],
    "load.plant": {"dof": "p6", **WAVE},
    "actuator.names": ["a0", "a1"],
    "actuator.stiffness": [40.0, 30.0],
    "actuator.pretension": [0.0, 0.0],
}

CASES = {
    "paper": {},
    "three masses": {"name": "three_mass"},
    "transmission": {"name": "transmission"},
    "motor poles": {"actuator.motor_poles": [400.0, 2000.0]},
    "loads": {"load.plant": {"dof": "x1", **WAVE}, "load.numerical": {"dof": "x2", **MANY}},
    "constant load": {"load.numerical": {"dof": "x2", "kind": "constant", "force": 0.3}},
    "no delays": AT_ONCE,
    "clocked references": {"timing.td4": 0.003},
    "rows off the clocks": {"timing.tau1": 0.0041234},
    "noise": NOISE,
    "effects": {"effects": [STAGE, BRANCH, SLOW, SHIFT, WRONG]},
    "seven masses": MASSES,
    "seven masses, motor poles": MASSES | {"actuator.motor_poles": [400.0, 2000.0]},
    "seven masses, irregular links": MASSES | {"effects": [LOOSE]},
    "irregular links": {"effects": [LOOSE, SHAKY]},
    "irregular, noise": {"effects": [SHAKY, LATE], **NOISE},
    "irregular, motor poles": {"effects": [SHAKY], "actuator.motor_poles": [400.0, 2000.0]},
    "irregular, three masses": {"name": "three_mass", "effects": [SHAKY, LOOSE]},
    "irregular, loads": {"effects": [SHAKY], "load.plant": {"dof": "x1", **WAVE}},
    "irregular, clocked references": {"effects": [SHAKY, LATE], "timing.td4": 0.003},
    "irregular by a nanosecond": {"effects": [TREMBLING], **AT_ONCE},
}


def changed(name="paper", effects=(), **changes):
    names = [f"e{i}" for i in range(len(effects))]
    added = {"effects": names, **dict(zip(names, effects, strict=True))} if effects else {}
    return apply(shipped_spec(name), changes | added)


@pytest.mark.parametrize("case", CASES)
def test_fast_way_gives_the_same_motion(case):
    spec = changed(**CASES[case])
    assert linear_blocks(spec, 1_000_000, 1_000_000, energies=False) is not None
    fast = simulate(spec, 12.0, 0.0017, energies=False)
    slow = simulate_any(spec, 12_000_000_000, 1_700_000)
    counted = simulate(spec, 12.0, 0.0017)
    assert np.abs(counted.plant_position - fast.plant_position).max() < 1e-12
    for term, work in slow.energies.items():
        assert np.abs(counted.energies[term] - work).max() < 1e-11, term
    for name in ("plant_position", "numerical_position"):
        assert np.abs(getattr(fast, name) - getattr(slow, name)).max() < 1e-12
    for name in ("plant_velocity", "numerical_velocity", "force_reference", "actuator_force"):
        assert np.abs(getattr(fast, name) - getattr(slow, name)).max() < 1e-11


@pytest.mark.parametrize("case", [case for case in CASES if case.startswith("irregular")])
@pytest.mark.parametrize("step", [1_700_000, 30_000_000, 1_700_001], ids=["near", "far", "off the clocks"])
def test_irregular_events_give_the_same_motion_for_rows_anywhere(case, step):
    spec = changed(**CASES[case])
    slow = simulate_any(spec, 3_000_000_000, step)
    fast = simulate(spec, 3.0, step * 1e-9)
    for name in ("plant_position", "numerical_velocity", "force_reference", "actuator_force"):
        assert np.abs(getattr(fast, name) - getattr(slow, name)).max() < 1e-12
    for term, work in slow.energies.items():
        assert np.abs(fast.energies[term] - work).max() < 1e-11, term


@pytest.mark.parametrize("case", ["paper", "seven masses", "motor poles"])
@pytest.mark.parametrize("step", [0.0017, 0.0012, 0.00121, 0.4])
def test_blocks_have_the_energies_of_the_whole(case, step):
    spec = changed(**CASES[case])
    whole, blocks = simulate(spec, 21.0, step), list(simulate_blocks(spec, 21.0, step))
    assert len(blocks) > 1
    for term, work in whole.energies.items():
        assert np.abs(np.concatenate([block.energies[term] for block in blocks]) - work).max() < 1e-13, term
    assert np.abs(whole.balance_error).max() < 1e-12


@pytest.mark.parametrize("duration", [0.0004, 0.0012, 0.0121, 0.1])
def test_a_test_may_end_anywhere(duration):
    spec = shipped_spec("paper")
    fast, slow = simulate(spec, duration, 0.0003), simulate_any(spec, round(duration * 1e9), 300_000)
    for term, work in slow.energies.items():
        assert fast.energies[term].shape == work.shape
        assert np.abs(fast.energies[term] - work).max() < 1e-12, term


def test_what_is_not_linear_takes_the_other_way():
    friction = {"block": "plant", "dof": "x1", "kind": "coulomb_friction", "force": 0.05}
    assert linear_blocks(changed(effects=[friction]), 1_000_000, 1_000_000, energies=False) is None
