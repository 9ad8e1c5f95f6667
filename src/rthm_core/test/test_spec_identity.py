"""Spec -> file -> spec is the identity, for random valid specs."""

from __future__ import annotations

from typing import Any

import numpy as np
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from rthm_core.effects import BLOCKS, effect, kinds
from rthm_core.effects.blocks import PLACES
from rthm_core.effects.formula import FormulaText
from rthm_core.quantity import Quantity, Text
from rthm_core.spec import Spec, parameters, read_spec, spec_from_parameters, write_spec
from rthm_core.spec.building import nested

Flat = dict[str, Any]
NAMES = st.text("abxyzé1_ .yn", min_size=1, max_size=6).map(lambda text: f"{text.strip()}k")
NUMBERS = st.floats(-1e12, 1e12)
POSITIVE = st.floats(1e-9, 1e9)
SIZES = st.floats(0.0, 1e9)


def symmetric(draw: st.DrawFn, n: int, *, definite: bool) -> list[float]:
    half = np.array(draw(st.lists(st.floats(-2.0, 2.0), min_size=n * n, max_size=n * n))).reshape(n, n)
    matrix = half @ half.T + np.eye(n) if definite else half + half.T
    return list(((matrix + matrix.T) / 2).ravel())


def many(draw: st.DrawFn, count: int, numbers: st.SearchStrategy[float] = NUMBERS) -> list[float]:
    return draw(st.lists(numbers, min_size=count, max_size=count))


def substructure(draw: st.DrawFn, key: str, dofs: list[str]) -> Flat:
    n = len(dofs)
    return {
        f"{key}.dofs": dofs,
        f"{key}.mass": symmetric(draw, n, definite=True),
        f"{key}.damping": many(draw, n * n),
        f"{key}.stiffness": symmetric(draw, n, definite=False),
        f"{key}.initial_position": many(draw, n),
        f"{key}.initial_velocity": many(draw, n),
    }


def load(draw: st.DrawFn, key: str, dofs: list[str]) -> Flat:
    low = draw(st.floats(0.0, 10.0))
    kinds_of_load: list[Flat] = [
        {"kind": "none"},
        {"kind": "constant", "force": draw(NUMBERS)},
        {"kind": "harmonic", "amplitude": draw(NUMBERS), "frequency": draw(SIZES), "phase": draw(NUMBERS)},
        {"kind": "multisine", "rms": 1.0, "low": low, "high": low + 1.0, "count": draw(st.integers(1, 99))},
        {"kind": "file", "path": "/data/força 1.csv"},
    ]
    entries = {"dof": draw(st.sampled_from(dofs)), **draw(st.sampled_from(kinds_of_load))}
    return {f"{key}.{name}": value for name, value in entries.items()}


def loop(draw: st.DrawFn, plant: list[str], numerical: list[str], actuators: list[str]) -> Flat:
    m = len(actuators)
    flat = {
        "interface.plant_dof": [draw(st.sampled_from(plant)) for _ in range(m)],
        "interface.numerical_dof": [draw(st.sampled_from(numerical)) for _ in range(m)],
        "interface.stiffness": many(draw, m),
        "interface.damping": many(draw, m),
        "actuator.names": actuators,
        "actuator.stiffness": many(draw, m, POSITIVE),
        "actuator.pretension": many(draw, m, SIZES),
        "actuator.compensator": draw(st.sampled_from(["none", "taylor", "passivity"])),
    }
    for name in ("td1", "td2", "td3"):
        flat[f"timing.{name}"] = draw(st.floats(1e-6, 1.0))
    for name in ("td4", "tau1", "tau2", "tau3", "tau4"):
        flat[f"timing.{name}"] = draw(st.floats(0.0, 1.0))
    if draw(st.booleans()):
        flat["actuator.motor_poles"] = many(draw, 2, POSITIVE)
    if draw(st.booleans()):
        names = ("spring", "wire", "radius", "inertia", "damping")
        flat |= {f"actuator.transmission.{name}": draw(st.floats(1e-6, 1e6)) for name in names}
    return flat


def number_of(draw: st.DrawFn, entry: Quantity) -> float:
    low = -1e6 if entry.lowest is None else entry.lowest
    high = 1e6 if entry.highest is None else entry.highest
    return draw(st.floats(low, high).filter(entry.holds))


def one_effect(draw: st.DrawFn, name: str, blocks: list[str], places: dict[str, list[str]]) -> Flat:
    block = draw(st.sampled_from([block for block in blocks if kinds(block)]))
    dofs = places["dof"]
    alone = {"inertial_coupling"} if len(dofs) == 1 else set()
    kind = draw(st.sampled_from([kind for kind in kinds(block) if kind not in alone]))
    entries: Flat = {"block": block, "kind": kind}
    if block in PLACES:
        entries[PLACES[block]] = draw(st.sampled_from(places[PLACES[block]]))
    for parameter, entry in effect(kind, block).parameters.items():
        text = f"-2 * {entry.variables[0]}" if isinstance(entry, FormulaText) else "interface.stiffness[0]"
        entries[parameter] = text if isinstance(entry, Text) else number_of(draw, entry)
    if kind == "extra_delay":  # how early a delay may be depends on the others, see test_early_delays
        entries["delay"] = abs(entries["delay"])
    for joining in {"mass_change": ["change"], "growing_mass": ["rate"]}.get(kind, []):
        entries[joining] = abs(entries[joining])  # no more may leave than there is, see test_mass
    if kind == "inertia":
        entries["mass"] = "2 * x**2"
    if kind == "inertial_coupling":
        entries |= {"mass": "0 * x * y", "relative_to": next(dof for dof in dofs if dof != entries["dof"])}
    return {f"{name}.{key}": value for key, value in entries.items()}


@st.composite
def specs(draw: st.DrawFn) -> Flat:
    names = draw(st.lists(NAMES, min_size=7, max_size=7, unique=True))
    plant = names[: draw(st.integers(1, 3))]
    numerical, actuators = names[3 : 3 + draw(st.integers(1, 2))], names[5 : 5 + draw(st.integers(1, 2))]
    is_loop = draw(st.booleans())
    flat = substructure(draw, "plant", plant) | load(draw, "load.plant", plant)
    if is_loop:
        flat |= substructure(draw, "numerical", numerical) | load(draw, "load.numerical", numerical)
        flat |= loop(draw, plant, numerical, actuators)
    if draw(st.booleans()):
        flat |= {"noise.force": draw(SIZES), "noise.seed": draw(st.integers(0, 2**53))}
        flat |= {"uncertainty.plant.mass": draw(st.floats(0.0, 2.0)), "limits.rate": draw(POSITIVE)}
    blocks = list(BLOCKS) if is_loop else ["plant", "sensor.position"]
    effects = draw(st.lists(st.sampled_from(["guide", "band", "y", "on", "e1"]), unique=True, max_size=3))
    for name in effects:
        flat |= one_effect(draw, name, blocks, {"dof": plant, "actuator": actuators})
    return flat | ({"effects": effects} if effects else {})


RANDOM_SPECS = specs().map(spec_from_parameters)
THOROUGH = settings(max_examples=100, deadline=None, suppress_health_check=list(HealthCheck))


@THOROUGH
@given(RANDOM_SPECS)
def test_spec_to_file_to_spec_is_the_identity(spec: Spec) -> None:
    assert read_spec(write_spec(spec)) == spec
    assert spec.expanded() == write_spec(read_spec(spec.expanded()))


@THOROUGH
@given(RANDOM_SPECS)
def test_spec_to_ros_parameters_to_spec_is_the_identity(spec: Spec) -> None:
    assert spec_from_parameters({one.name: one.value for one in parameters(spec)}) == spec


@THOROUGH
@given(RANDOM_SPECS)
def test_plain_yaml_reads_our_file_as_we_do(spec: Spec) -> None:
    (tree,) = [node["ros__parameters"] for node in yaml.safe_load(write_spec(spec)).values()]
    assert tree == nested({one.name: one.value for one in parameters(spec)})
