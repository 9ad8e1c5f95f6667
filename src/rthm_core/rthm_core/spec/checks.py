"""What the parts of a spec owe each other: lengths, names, matrices, completeness.

Every check raises `RefusedError` with the dotted key.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rthm_core.clock import to_ns
from rthm_core.effects.blocks import PLACES, check_block, family
from rthm_core.effects.laws import has_coupling
from rthm_core.errors import MISSING, RefusedError, suggestion
from rthm_core.spec.load import MultisineLoad
from rthm_core.spec.masses import heavy, instants, mass_at
from rthm_core.spec.sections import MATRICES

if TYPE_CHECKING:
    from rthm_core.spec.schema import EffectSpec, Spec, SubstructureSpec

LOOP = ("numerical", "interface", "actuator", "timing")
COMPUTED = {
    "numerical": ("numerical.", "interface."),
    "controller": ("actuator.", "timing.", "plant.", "numerical.", "interface."),
}
"""Sections that a computing block may have wrong."""


def check(spec: Spec) -> None:
    """Check everything that no section can check alone."""
    _complete(spec)
    _substructure("plant", spec.plant)
    if spec.numerical:
        _substructure("numerical", spec.numerical)
    _names_apart(spec)
    _actuator(spec)
    _interface(spec)
    _loads(spec)
    _zero(spec)
    for one in spec.effects:
        _effect(spec, one)
    check_mass(spec)
    check_delays(spec)


def _complete(spec: Spec) -> None:
    """A plant alone or a whole loop; a plant with timing is a plant alone whose sampling is known."""
    given = [name for name in LOOP if getattr(spec, name) is not None]
    missing = [name for name in LOOP if name not in given]
    if missing and given not in ([], ["timing"]):
        way_out = f"add {' and '.join(missing)}, or remove {' and '.join(given)} for a plant alone"
        raise RefusedError(
            MISSING, f"given, as a loop needs {', '.join(('plant', *LOOP))}", way_out, missing[0]
        )


def _substructure(key: str, section: SubstructureSpec) -> None:
    n = section.n
    if n == 0:
        raise RefusedError(section.dofs, "at least one name", "name each degree of freedom", f"{key}.dofs")
    _distinct(f"{key}.dofs", section.dofs)
    for name in MATRICES:
        _length(f"{key}.{name}", getattr(section, name), n * n, f"a list of {n} x {n} numbers, row by row")
    for name in ("initial_position", "initial_velocity"):
        _length(f"{key}.{name}", getattr(section, name), n, f"a list with one number for each of {n} dof(s)")
    mass = np.array(section.mass).reshape(n, n)
    if not _symmetric(mass) or not _positive_definite(mass):
        raise RefusedError(section.mass, "a symmetric, positive definite matrix", within=f"{key}.mass")
    if not _symmetric(np.array(section.stiffness).reshape(n, n)):
        raise RefusedError(
            section.stiffness, "a symmetric matrix, as springs have one", within=f"{key}.stiffness"
        )


def _symmetric(matrix: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> bool:
    return bool(np.all(np.abs(matrix - matrix.T) <= 1e-9 * np.abs(matrix).max()))


def _positive_definite(matrix: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> bool:
    try:
        return bool(np.isfinite(np.linalg.cholesky(matrix)).all())
    except np.linalg.LinAlgError:
        return False


def _length(key: str, values: Sequence[object], count: int, allowed: str) -> None:
    if len(values) != count:
        raise RefusedError(values, allowed, f"give {count} instead of {len(values)}", key)


def _distinct(key: str, names: Sequence[str]) -> None:
    for i, name in enumerate(names):
        if name in names[:i]:
            raise RefusedError(name, "a name that is used once", "rename one of the two", f"{key}[{i}]")


def _names_apart(spec: Spec) -> None:
    """One name means one thing in topics and tables."""
    taken = list(spec.plant.dofs)
    for key, names in (
        ("numerical.dofs", spec.numerical.dofs if spec.numerical else ()),
        ("actuator.names", spec.actuator.names if spec.actuator else ()),
    ):
        for i, name in enumerate(names):
            if name in taken:
                raise RefusedError(
                    name, "a name that no other dof or actuator has", "rename it", f"{key}[{i}]"
                )
        taken.extend(names)


def _actuator(spec: Spec) -> None:
    if spec.actuator is None:
        return
    m = len(spec.actuator.names)
    if m == 0:
        raise RefusedError(spec.actuator.names, "at least one name", "name each actuator", "actuator.names")
    _distinct("actuator.names", spec.actuator.names)
    if spec.actuator.stiffness is None and spec.actuator.transmission is None:
        way_out = "add actuator.stiffness (k_tot) or actuator.transmission"
        raise RefusedError(MISSING, "given", way_out, "actuator.stiffness")
    for name in ("stiffness", "pretension"):
        values = getattr(spec.actuator, name)
        if values is not None:
            _length(f"actuator.{name}", values, m, f"a list with one number for each of {m} actuator(s)")


def _interface(spec: Spec) -> None:
    if spec.interface is None or spec.actuator is None or spec.numerical is None:
        return
    m = len(spec.actuator.names)
    for name, values in spec.interface.items():
        _length(f"interface.{name}", values, m, f"a list with one entry for each of {m} actuator(s)")
    for name, known in (("plant_dof", spec.plant.dofs), ("numerical_dof", spec.numerical.dofs)):
        for i, dof in enumerate(getattr(spec.interface, name)):
            _known(f"interface.{name}[{i}]", dof, known)


def _known(key: str, name: str, known: Sequence[str]) -> None:
    if name not in known:
        raise RefusedError(name, f"one of {', '.join(known)}", suggestion(name, list(known)), key)


def _zero(spec: Spec) -> None:
    if spec.zero is None:
        return
    n, m = spec.plant.n, len(spec.actuator.names) if spec.actuator else 0
    for name, values in spec.zero.items():
        count, of = (n, "dof") if name in ("position", "velocity") else (m, "actuator")
        if values is not None:
            _length(f"zero.{name}", values, count, f"a list with one number for each of {count} {of}(s)")


def _loads(spec: Spec) -> None:
    for side, substructure in (("plant", spec.plant), ("numerical", spec.numerical)):
        load = getattr(spec.load, side)
        if load is None:
            continue
        if substructure is None:
            raise RefusedError(
                load.kind, f"left out, as there is no section {side}", within=f"load.{side}.kind"
            )
        _known(f"load.{side}.dof", load.dof, substructure.dofs)
        if isinstance(load, MultisineLoad) and load.high < load.low:
            raise RefusedError(
                load.high, f"at least load.{side}.low, {load.low:g}", within=f"load.{side}.high"
            )


def _effect(spec: Spec, one: EffectSpec) -> None:
    if [other.name for other in spec.effects].count(one.name) > 1:
        raise RefusedError(one.name, "a name that is used once", "list each effect once", "effects")
    block = check_block(one.block)
    if family(block) != "plant" and not spec.is_loop and not block.startswith("sensor."):
        allowed = "plant or a sensor of it, as the spec describes a plant alone"
        raise RefusedError(block, allowed, within=f"{one.name}.block")
    known = {"dof": spec.plant.dofs, "actuator": spec.actuator.names if spec.actuator else ()}
    for key, names in known.items():
        given = getattr(one, key)
        if PLACES.get(block) == key:
            allowed = f"one of {', '.join(names)}" if names else "an actuator, and the spec has none"
            if given not in names:
                raise RefusedError(given, allowed, f"say which {key}", f"{one.name}.{key}")
        elif given is not None:
            raise RefusedError(
                given, f"left out, as {block} has no {key}", f"remove {key}", f"{one.name}.{key}"
            )
    if one.relative_to is not None or has_coupling(one.law):
        _between(spec, one)
    if one.law.changes == "entry":
        _wrong_parameter(spec, one)


def _between(spec: Spec, one: EffectSpec) -> None:
    others = [dof for dof in spec.plant.dofs if dof != one.dof]
    within = f"{one.name}.relative_to"
    if one.relative_to is None:
        allowed = f"one of {', '.join(others)}" if others else "another dof, and the plant has only one"
        raise RefusedError(MISSING, allowed, f"say which dof {one.dof} is coupled with", within)
    if one.block != "plant" or not others:
        allowed = "left out, as only an effect on a plant with several dofs acts between two"
        raise RefusedError(one.relative_to, allowed, "remove relative_to", within)
    _known(within, one.relative_to, others)


def _wrong_parameter(spec: Spec, one: EffectSpec) -> None:
    from rthm_core.spec.numbers import numbers  # which needs the schema

    known = {name: entry for name, entry in numbers(spec).items() if name.startswith(COMPUTED[one.block])}
    name = str(one.parameters["name"])
    if name not in known:
        allowed = f"a number that {one.block} computes with ({', '.join(list(known)[:8])} ...)"
        raise RefusedError(name, allowed, suggestion(name, list(known)), f"{one.name}.name")
    if not known[name].holds(float(one.parameters["value"])):
        raise RefusedError(
            one.parameters["value"], f"{known[name].bounds}, as {name}", within=f"{one.name}.value"
        )


def check_mass(spec: Spec) -> None:
    """No effect takes away more than there is, nor couples two dofs by more than they have."""
    if _has_mass(spec, heavy(spec)):
        return
    joining = [one for one in heavy(spec) if not has_coupling(one.law)]
    allowed, one = "such that what leaves the plant is less than its mass", joining[0] if joining else None
    if one is None or _has_mass(spec, joining):
        allowed = "such that the mass matrix of the plant is positive definite where it begins"
        one = next(one for one in heavy(spec) if has_coupling(one.law))
    name, value = next(iter({**one.numbers, **one.parameters}.items()))
    raise RefusedError(value, allowed, within=f"{one.name}.{name}")


def _has_mass(spec: Spec, some: Sequence[EffectSpec]) -> bool:
    """Whether all that moves has mass with some of the effects."""
    return all(_positive_definite(mass_at(spec, t, some)) for t in instants(spec)) if some else True


def check_delays(spec: Spec) -> None:
    """A delay may be shorter than its tau, but nothing arrives before it was sent."""
    for one in spec.effects:
        if one.law.changes != "delay" or spec.timing is None or float(one.parameters["delay"]) >= 0.0:
            continue
        name = one.link or "tau4"
        also = (f"link.{name}", one.block)
        others = [e for e in spec.effects if e.law.changes == "delay" and e.block in also and e is not one]
        rest = getattr(spec.timing, name) + sum(float(e.parameters["delay"]) for e in others)
        if to_ns(rest + float(one.parameters["delay"])) < 0:
            besides = f" and {', '.join(e.name for e in others)}" if others else ""
            allowed = f"at least {0.0 - rest:g} s, as timing.{name}{besides} leave no more to be taken off"
            raise RefusedError(one.parameters["delay"], allowed, within=f"{one.name}.delay")
