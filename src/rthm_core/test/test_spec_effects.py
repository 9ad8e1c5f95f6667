"""The registry of effects knows what the contract lists, and every kind says what it is."""

from __future__ import annotations

import subprocess
import sys

import pytest

from rthm_core.effects import BLOCKS, Effect, EffectParameter, effect, kinds, register
from rthm_core.effects.blocks import SENSORS, family
from rthm_core.errors import RefusedError
from rthm_core.quantity import Text

# section 6 of the contract, word for word
CONTRACT = {
    "plant": {
        "coulomb_friction": ["force"],
        "stribeck_friction": ["coulomb_force", "static_force", "stribeck_velocity"],
        "quadratic_drag": ["coefficient"],
        "cubic_stiffness": ["coefficient"],
        "quadratic_stiffness": ["coefficient"],
        "end_stop": ["position", "stiffness", "damping"],
        "clearance": ["gap", "stiffness"],
        "bouc_wen": ["alpha", "A", "beta", "gamma", "n"],
        "maxwell_branch": ["stiffness", "damping"],
        "hidden_mode": ["mass", "frequency", "damping_ratio"],
        "fluid_memory": ["gain", "frequency", "damping_ratio"],
        "harmonic_load": ["amplitude", "frequency", "phase"],
        "constant_load": ["force"],
    },
    "wire": {
        "backlash": ["gap"],
        "slack": ["pretension"],
        "hardening": ["coefficient"],
        "pulley_inertia": ["mass", "damping"],
        "pulley_friction": ["force"],
        "bouc_wen": ["alpha", "A", "beta", "gamma", "n"],
        "maxwell_branch": ["stiffness", "damping"],
    },
    "motor": {
        "lag": ["time_constant"],
        "second_order": ["frequency", "damping_ratio"],
        "extra_delay": ["delay"],
        "rate_limit": ["rate"],
        "saturation": ["limit"],
        "quantisation": ["step"],
    },
    "link": {"extra_delay": ["delay"], "jitter": ["std"], "loss": ["fraction"], "clock_offset": ["offset"]},
    "sensor": {
        "bias": ["bias"],
        "scale": ["scale"],
        "drift": ["rate"],
        "lag": ["time_constant"],
        "quantisation": ["step"],
    },
    "numerical": {"wrong_parameter": ["name", "value"]},
    "controller": {"wrong_parameter": ["name", "value"]},
}

EVERY = [(block, kind) for block in BLOCKS for kind in kinds(block)]


@pytest.mark.parametrize("block", BLOCKS)
def test_every_kind_of_the_contract_is_known_with_its_parameters(block: str) -> None:
    known = {kind: list(effect(kind, block).parameters) for kind in kinds(block)}
    assert CONTRACT[family(block)].items() <= known.items()


@pytest.mark.parametrize(("block", "kind"), EVERY)
def test_every_kind_says_what_it_is(block: str, kind: str) -> None:
    declared = effect(kind, block)
    assert declared.equation
    assert declared.__doc__
    values = {name: "name" if isinstance(entry, Text) else 2.5 for name, entry in declared.parameters.items()}
    words = declared.describe(block, "here", values)
    assert "here" in words or block in words
    assert "signal" not in words
    assert "{" not in words


@pytest.mark.parametrize(("block", "kind"), EVERY)
def test_every_parameter_has_a_unit_and_a_description(block: str, kind: str) -> None:
    for entry in effect(kind, block).parameters.values():
        assert entry.description
        assert isinstance(entry, Text) or entry.unit


def test_the_unit_of_a_sensors_effect_follows_its_signal() -> None:
    bias = effect("bias", "sensor.force")
    assert [bias.unit("bias", f"sensor.{name}") for name in SENSORS] == ["m", "m/s", "m/s^2", "N"]
    assert effect("drift", "sensor.force").unit("rate", "sensor.force") == "N/s"


def test_one_kind_may_be_declared_once_in_each_block() -> None:
    with pytest.raises(TypeError, match="twice for plant"):

        @register
        class Friction(Effect):
            kind = "coulomb_friction"
            blocks = ("plant",)

    assert effect("lag", "motor") is not effect("lag", "sensor.force")


def test_words_use_parameters_that_there_are() -> None:
    with pytest.raises(TypeError, match="force"):

        @register
        class Nameless(Effect):
            kind = "nameless"
            blocks = ("plant",)
            parameters = {"gain": EffectParameter("1", "gain")}
            words = "a {force}"


def test_an_unknown_block_or_kind_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(RefusedError, match="one of plant, wire"):
        kinds("plnt")
    with pytest.raises(RefusedError, match="a kind that motor knows"):
        effect("coulomb_friction", "motor")


def test_what_effects_declare_is_known_without_compiling_anything() -> None:
    code = "import sys; from rthm_core.effects import kinds; kinds('plant'); print('numba' in sys.modules)"
    told = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    assert told == "False\n"


def test_the_coefficient_of_a_power_of_the_motion_may_be_of_any_size_and_others_may_not() -> None:
    """A hundredth of the stiffness of a beam of a micrometre, 1e5 N/m, is 1e13 N/m^3 at 10 nm."""
    assert number("cubic_stiffness", "coefficient").convert(1e13) == 1e13
    with pytest.raises(RefusedError):
        number("coulomb_friction", "force").convert(1e13)


def number(kind: str, name: str) -> EffectParameter:
    found = effect(kind, "plant").parameters[name]
    assert isinstance(found, EffectParameter)
    return found
