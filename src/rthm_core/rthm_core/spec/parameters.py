"""A spec as ROS parameters, and back: dotted names, values, types, units, bounds."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, get_args

from pydantic import ValidationError

from rthm_core.effects.base import effect
from rthm_core.errors import MISSING, InputError, Refused, refusal, unknown
from rthm_core.quantity import Quantity, Text
from rthm_core.spec.catalogue import ROOT
from rthm_core.spec.defaults import completed
from rthm_core.spec.effect import HEAD, EffectSpec, from_section
from rthm_core.spec.entries import Entry, Number
from rthm_core.spec.messages import input_error
from rthm_core.spec.schema import Spec
from rthm_core.spec.sections import Section

Value = float | int | str | list[float] | list[str]


@dataclass(frozen=True)
class Parameter:
    """One entry of a spec, as a ROS parameter is declared.

    Attributes
    ----------
    name
        Dotted name, as in the file.
    value
        Float, int, str, or a list of floats or of str.
    type
        ``double``, ``double_array``, ``integer``, ``string`` or ``string_array``.
    unit, description
        For the descriptor; the unit of a pure number or a text is "1" or "".
    minimum, maximum
        Bounds of the number or of each element; None: none.
    allowed
        What may be given, in words.
    """

    name: str
    value: Value
    type: str
    unit: str = ""
    description: str = ""
    minimum: float | None = None
    maximum: float | None = None
    allowed: str = ""


def parameters(spec: Spec) -> list[Parameter]:
    """Every entry of a spec, in the order of the schema; absent optional ones and empty lists are left out."""
    found = list(_of_section("", spec))
    if spec.effects:
        names = [one.name for one in spec.effects]
        found.append(Parameter("effects", names, "string_array", "", "names of the effects", allowed="a list of names"))
    for one in spec.effects:
        found.extend(_of_effect(one))
    return found


def _of_section(key: str, section: Section) -> Iterator[Parameter]:
    entries = dict(section.entries())
    for name, value in section.items():
        dotted = f"{key}.{name}" if key else name
        if isinstance(value, Section):
            yield from _of_section(dotted, value)
        elif name in entries and value is not None and value != ():
            yield _parameter(dotted, value, entries[name])
        elif name == "kind":
            words = get_args(type(section).model_fields[name].annotation)
            yield Parameter(dotted, value, "string", "", "kind of load", allowed=f"one of {', '.join(words)}")


def _parameter(name: str, value: Any, entry: Entry) -> Parameter:
    stored = list(value) if isinstance(value, tuple) else value
    minimum, maximum = getattr(entry, "minimum", None), getattr(entry, "maximum", None)
    if isinstance(entry, Quantity):
        minimum, maximum = entry.lowest, entry.highest
    return Parameter(name, stored, entry.type, entry.unit, entry.description, minimum, maximum, entry.allowed)


def _of_effect(one: EffectSpec) -> Iterator[Parameter]:
    entries = dict(EffectSpec.entries())
    for key in ("block", "kind", "dof", "actuator"):
        value = getattr(one, key)
        if value is not None:
            yield _parameter(f"{one.name}.{key}", value, entries[key])
    declared = effect(one.kind, one.block)
    for name, value in one.parameters.items():
        dotted, entry = f"{one.name}.{name}", declared.parameters[name]
        if isinstance(entry, Text):
            yield Parameter(dotted, value, "string", "", entry.description, allowed=entry.allowed)
        else:
            unit = declared.unit(name, one.block)
            yield Parameter(
                dotted, value, "double", unit, entry.description, entry.lowest, entry.highest, entry.allowed
            )


def numbers(spec: Spec) -> dict[str, Quantity]:
    """Every single number of a spec with its bounds; elements of lists as ``plant.mass[0]``, of a list of one also as ``plant.mass``.

    ``actuator.stiffness`` stands for k_tot even where a transmission gives it.
    """
    found: dict[str, Quantity] = {}
    for name, value, entry in _quantities("", spec):
        if isinstance(value, float):
            found[name] = entry
        elif name != "actuator.stiffness":
            found |= _elements(name, value, entry)
    return found | _elements("actuator.stiffness", spec.k_tot, Number("N/m", "k_tot", above=0.0))


def _elements(name: str, values: tuple[float, ...], entry: Quantity) -> dict[str, Quantity]:
    whole = {name: entry} if len(values) == 1 else {}
    return whole | {f"{name}[{i}]": entry for i in range(len(values))}


def _quantities(key: str, section: Section) -> Iterator[tuple[str, Any, Quantity]]:
    entries = dict(section.entries())
    for name, value in section.items():
        dotted = f"{key}.{name}" if key else name
        entry = entries.get(name)
        if isinstance(value, Section):
            yield from _quantities(dotted, value)
        elif isinstance(entry, Quantity) and value is not None:
            yield dotted, value, entry


def spec_from_parameters(given: Mapping[str, Any], besides: Collection[str] = ()) -> Spec:
    """Return the spec that ROS parameters describe.

    Parameters
    ----------
    given
        Values by dotted name.
    besides
        Names that are no part of a spec and are passed over, such as a node's own parameters.

    Raises
    ------
    InputError
        On the first thing that is not allowed.
    """
    return spec_from_tree(nested({name: value for name, value in given.items() if name not in besides}))


def nested(flat: Mapping[str, Any]) -> dict[str, Any]:
    """Sections within sections from dotted names."""
    tree: dict[str, Any] = {}
    for name, value in flat.items():
        *path, last = name.split(".")
        section = tree
        for part in path:
            section = section.setdefault(part, {})
            if not isinstance(section, dict):
                raise refusal(name.rpartition(".")[0], section, f"a section, as {name} is given too")
        if last in section:
            raise refusal(name, value, "a section, as entries of it are given too")
        section[last] = value
    return tree


def spec_from_tree(tree: Mapping[str, Any]) -> Spec:
    """Return the spec of nested sections as they stand in a file."""
    gathered = completed(_with_effects(dict(tree)))
    try:
        return Spec.model_validate(gathered)
    except ValidationError as error:
        raise input_error(error, gathered) from None


def _with_effects(tree: dict[str, Any]) -> dict[str, Any]:
    """Move the sections of effects into the list of effects."""
    names = tree.get("effects", [])
    if not isinstance(names, list | tuple) or not all(isinstance(name, str) for name in names):
        raise refusal("effects", names, "a list of names, each with a section of that name")
    sections = {key: value for key, value in tree.items() if key not in ROOT}
    for key, value in sections.items():
        if key not in names:
            raise _stray(key, value)
    effects = []
    for name in names:
        _check_name(name)
        section = sections.get(name, MISSING)
        if not isinstance(section, dict):
            raise refusal(name, section, f"a section with {', '.join(HEAD[:2])} and parameters", f"add it, or take {name} out of effects")
        try:
            effects.append(from_section(name, section))
        except Refused as refused:
            raise refused.at(name) from None
    return {key: value for key, value in tree.items() if key in ROOT} | {"effects": effects}


def _check_name(name: str) -> None:
    if name in ROOT or not name.isascii() or not name.isidentifier() or len(name) > 60:
        raise refusal("effects", name, "names of letters, digits and _ that are no section of the spec", "rename the effect")


def _stray(key: str, value: Any) -> InputError:
    if isinstance(value, dict) and ("kind" in value or "block" in value):
        return refusal(f"effects (without {key})", "an incomplete list", f"one that names the section {key}", f"add {key} to effects")
    return unknown(key, value, ROOT)
