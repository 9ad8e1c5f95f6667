"""Sensitivities of a trajectory against differences of whole simulations, which know nothing of tangents."""

import time
from functools import partial

import numpy as np
import pytest
from benchmarks.engine.ours import CUBIC, FRICTION, HARDENING, STRIBECK, chain

from rthm_core.engine import sensitivities, simulate
from rthm_core.engine.sensitivities import physical_numbers
from rthm_core.engine.tangents.entries import in_blocks
from rthm_core.errors import InputError
from rthm_core.spec import apply, shipped_spec

SIGNALS = ("plant_position", "plant_velocity", "numerical_position", "force_reference", "actuator_force")
WAVE = {"dof": "x1", "kind": "harmonic", "amplitude": 1.0, "frequency": 2.4, "phase": 0.3}
SHAKY = {"block": "link.tau4", "kind": "jitter", "std": 0.001}


GUIDE = {"block": "plant", "dof": "x1", "kind": "coulomb_friction", "force": 0.05}


def rubbing(force, **changes):
    guide = GUIDE | {"force": force}
    effects = [
        "guide",
        *(name for name, value in changes.items() if isinstance(value, dict) and "block" in value),
    ]
    return apply(shipped_spec("paper"), {"effects": effects, "guide": guide} | changes)


def having(**parts):
    effects = [name for name, value in parts.items() if isinstance(value, dict)]
    return apply(shipped_spec("paper"), {"effects": effects} | parts)


LOOPS = {
    "linear": shipped_spec("paper"),
    "friction": rubbing(0.05),
    "friction behind motor poles": rubbing(0.05, **{"actuator.motor_poles": [400.0, 2000.0]}),
    "stick and slip": rubbing(0.6, **{"load.plant": WAVE}),
    "jitter": rubbing(0.05, shaky=SHAKY),
    "falling friction": having(guide=STRIBECK),
    "friction and spring": having(guide=FRICTION, spring=CUBIC),
    "spring that jitters": having(spring=CUBIC, shaky=SHAKY),
    "hardening wire": having(wire=HARDENING),
    "hardening wire behind motor poles": having(wire=HARDENING, **{"actuator.motor_poles": [400.0, 2000.0]}),
    "stop": having(
        stop={
            "block": "plant",
            "dof": "x1",
            "kind": "end_stop",
            "position": 0.05,
            "stiffness": 40.0,
            "damping": 0.5,
        }
    ),
}


def difference(spec, name, value, duration, sample, part=1e-5):
    """Central difference of whole simulations."""
    high, low = (
        simulate(apply(spec, {name: value * (1.0 + sign * part)}), duration, sample, energies=False)
        for sign in (1.0, -1.0)
    )
    return {one: (getattr(high, one) - getattr(low, one)) / (2.0 * part * value) for one in SIGNALS}


@pytest.mark.parametrize("which", LOOPS)
def test_tangents_agree_with_differences(which):
    spec, duration, sample = LOOPS[which], 6.0, 0.0017
    values = {"plant.mass": 1.2, "numerical.stiffness": 6.0, "actuator.stiffness": 40.0}
    for one in spec.effects:
        if not one.block.startswith("link"):
            values |= {f"{one.name}.{number}": value for number, value in one.numbers.items()}
    found = sensitivities(spec, duration, list(values), sample)
    assert found.tangents
    plain = simulate(spec, duration, sample)
    assert np.abs(found.trajectory.plant_position - plain.plant_position).max() < 1e-12
    for term, work in plain.energies.items():
        assert np.abs(found.trajectory.energies[term] - work).max() < 1e-10, term
    for name, value in values.items():
        part = 1e-5 if value > 0.1 else 1e-4  # runs are right to 1e-12 m, which steps must stand out from
        expected = difference(spec, name, value, duration, sample, part)
        for signal in SIGNALS:
            apart = np.abs(getattr(found.by_parameter[name], signal) - expected[signal])
            # a row between the two instants of a switch sees a jump in one of the two runs only
            assert np.quantile(apart, 0.99) < 1e-6 * np.abs(expected[signal]).max(), (name, signal)


@pytest.mark.parametrize("which", LOOPS)
def test_counting_works_changes_no_tangent(which):
    names = ["plant.mass", "actuator.stiffness"]
    counting, without = (
        sensitivities(LOOPS[which], 3.0, names, 0.0017, energies=energies) for energies in (True, False)
    )
    assert not without.trajectory.energies
    for name in names:
        for signal in SIGNALS:
            one, other = (getattr(found.by_parameter[name], signal) for found in (counting, without))
            assert np.abs(one - other).max() < 1e-9 * np.abs(other).max(), (name, signal)


def test_signals_of_several_dofs_are_where_they_belong():
    spec, name = chain(3, 2), "interface.stiffness[1]"
    found, plain = sensitivities(spec, 2.0, [name], 0.0017), simulate(spec, 2.0, 0.0017)
    assert found.tangents
    expected = difference(spec, name, 6.0, 2.0, 0.0017)
    for signal in SIGNALS:
        derivative, of_plain = getattr(found.by_parameter[name], signal), getattr(plain, signal)
        assert np.abs(derivative - expected[signal]).max() < 1e-6 * np.abs(expected[signal]).max(), signal
        assert np.abs(getattr(found.trajectory, signal) - of_plain).max() < 1e-10, signal


@pytest.mark.parametrize("kinds", [(0, 0, 1, 1, 1, 1, 1, 2, 2, 2), (0, 1, 0, 1, 0, 2, 2, 2, 2), (0, 1, 2)])
def test_rows_in_the_order_of_their_blocks_are_written_one_after_the_other(kinds):
    pattern = np.array(kinds)[:, None] == np.arange(3)

    def written(rows):
        return [row for blocks in in_blocks(rows, 3) for row in blocks.ravel().tolist()]

    assert set(written(pattern)) == set(range(len(kinds)))
    again = written(pattern[list(dict.fromkeys(written(pattern)))])
    assert again == sorted(again)


@pytest.mark.long
@pytest.mark.parametrize("which", ["linear", "falling friction"])
def test_a_tangent_is_the_same_among_many(which):
    """Beyond seven numbers there are several groups of lanes, for which kernels of their own are compiled."""
    names = ["plant.mass", "actuator.stiffness"]
    many, few = (sensitivities(LOOPS[which], 3.0, chosen, 0.0017) for chosen in (None, names))
    assert many.tangents and len(many.by_parameter) > 7
    for name in names:
        for signal in SIGNALS:
            one, other = (getattr(found.by_parameter[name], signal) for found in (many, few))
            assert np.abs(one - other).max() < 1e-9 * np.abs(other).max(), (name, signal)


@pytest.mark.long
def test_every_number_of_the_physics_is_taken_where_none_is_named():
    found = sensitivities(LOOPS["stick and slip"], 0.1)
    assert {"plant.mass", "interface.damping", "load.plant.amplitude", "guide.force"} <= set(
        found.by_parameter
    )
    assert not any(name.startswith(("timing", "noise")) for name in found.by_parameter)


def test_a_switch_moves_with_the_friction_that_causes_it():
    """A dof that friction alone brings to rest: it sticks after ``m v0^2 / (2 f)``."""
    spec = rubbing(
        0.6,
        **{
            "plant.damping": 0.0,
            "plant.stiffness": 0.0,
            "plant.initial_position": 0.0,
            "plant.initial_velocity": 0.01,
            "actuator.stiffness": 1e-6,
            "interface.stiffness": 0.0,
            "interface.damping": 0.0,
        },
    )
    found = sensitivities(spec, 0.1, ["guide.force", "plant.mass", "plant.initial_velocity"], 0.005)
    mass, velocity, force = 1.2, 0.01, 0.6
    rest = {
        "guide.force": -mass * velocity**2 / (2.0 * force**2),
        "plant.mass": velocity**2 / (2.0 * force),
        "plant.initial_velocity": mass * velocity / force,
    }
    for name, expected in rest.items():
        last = found.by_parameter[name]
        assert last.plant_position[-1, 0] == pytest.approx(expected, rel=1e-5)
        assert last.plant_velocity[-1, 0] == 0.0


@pytest.mark.parametrize("which", ["falling friction", "friction and spring", "hardening wire"])
def test_derivatives_take_a_few_simulations(which):
    """Two on a quiet machine; differences take two for each number."""
    spec = LOOPS[which]
    names = ["plant.mass", "plant.damping", "plant.stiffness", "numerical.mass"]
    names += [f"{one.name}.{number}" for one in spec.effects for number in one.numbers]
    calls = simulate, partial(sensitivities, names=names)
    times = []
    for _ in range(8):
        begins = []
        for call in calls:
            begins.append(time.process_time())
            call(spec, 20.0, sample=0.0012)
        begins.append(time.process_time())
        times.append((begins[2] - begins[1]) / (begins[1] - begins[0]))
    assert np.median(times[1:]) < 4.0


def test_loops_without_tangents_are_differenced():
    spring = {"block": "plant", "dof": "x1", "kind": "cubic_stiffness", "coefficient": 8.0}
    spec = apply(shipped_spec("paper"), {"effects": ["spring"], "spring": spring, "noise.position": 1e-5})
    found = sensitivities(spec, 2.0, ["spring.coefficient"], 0.01)
    assert not found.tangents
    expected = difference(spec, "spring.coefficient", 8.0, 2.0, 0.01, part=1e-4)["plant_position"]
    position = found.by_parameter["spring.coefficient"].plant_position
    assert np.abs(position - expected).max() < 1e-6 * np.abs(expected).max()


def test_a_parameter_at_its_bound_is_differenced_from_there():
    free = apply(shipped_spec("paper"), {"plant.damping": 0.0})
    found = sensitivities(free, 3.0, ["plant.damping"], 0.01)
    beside = sensitivities(apply(free, {"plant.damping": 1e-6}), 3.0, ["plant.damping"], 0.01)
    one, other = (s.by_parameter["plant.damping"].plant_position for s in (found, beside))
    assert np.abs(one - other).max() < 1e-5 * np.abs(other).max()


@pytest.mark.parametrize("name", ["timing.tau1", "noise.position", "plant.weight", "plant.mass[3]"])
def test_what_is_no_smooth_number_of_the_spec_is_refused_in_a_sentence(name):
    with pytest.raises(InputError, match=r"^[^\n]*\.$"):
        sensitivities(shipped_spec("paper"), 1.0, [name])


def test_an_effect_that_decides_when_something_happens_is_refused_in_a_sentence():
    late = {"block": "motor", "kind": "extra_delay", "actuator": "a1", "delay": 0.003}
    spec = rubbing(0.05, loads=SHAKY, late=late)  # names that begin as sections do
    assert not any(name.startswith(("loads", "late")) for name in physical_numbers(spec))
    for name in ("loads.std", "late.delay"):
        with pytest.raises(InputError, match=r"^[^\n]*\.$"):
            sensitivities(spec, 0.1, [name])


def test_an_effect_may_be_named_as_a_section_that_is_refused():
    spec = apply(rubbing(0.05), {"effects": ["noise_of_guide"], "noise_of_guide": dict(GUIDE)})
    assert sensitivities(spec, 0.1, ["noise_of_guide.force"]).tangents
