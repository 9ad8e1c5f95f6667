"""A spec as ROS parameters: dotted names, values, types, units, bounds."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Any

from rthm_core.quantity import Quantity, Text
from rthm_core.spec.effect import SPREAD, EffectSpec
from rthm_core.spec.entries import Entry, Name, Names
from rthm_core.spec.load import LOAD_KINDS
from rthm_core.spec.schema import Spec
from rthm_core.spec.sections import Section


@dataclass(frozen=True)
class Parameter:
    """One entry of a spec, as a ROS parameter is declared.

    Attributes
    ----------
    name
        Dotted name, as in the file.
    value
        A number, a text, or a list of either.
    type
        ``double``, ``double_array``, ``integer``, ``string`` or ``string_array``.
    unit, description
        For the descriptor; the unit of a pure number is "1", that of a text is empty.
    minimum, maximum
        Bounds of the number, or of each element; None: none.
    allowed
        What may be given, in words.
    """

    name: str
    value: float | int | str | list[float] | list[str]
    type: str
    unit: str
    description: str
    minimum: float | None
    maximum: float | None
    allowed: str


def parameters(spec: Spec) -> list[Parameter]:
    """Every entry of a spec, in the order of the schema; absent entries and empty lists are left out."""
    return [parameter(*one) for one in _placed(spec)]


def values(spec: Spec, without: Collection[str] = ()) -> dict[str, Any]:
    """Value of every one of the `parameters`, by name, but for those of some sections of the root."""
    return {name: _stored(value) for name, value, *_ in _placed(spec, without)}


Placed = tuple[str, Any, Entry | Quantity | Text, str | None]
"""What `parameter` takes."""


def _placed(spec: Spec, without: Collection[str] = ()) -> Iterator[Placed]:
    yield from _of_section("", spec, without)
    if "effects" in without:
        return
    if spec.effects:
        names = Names("names of the effects, each with its own section")
        yield "effects", [one.name for one in spec.effects], names, None
    for one in spec.effects:
        yield from _of_effect(one)


def _of_section(key: str, section: Section, without: Collection[str] = ()) -> Iterator[Placed]:
    entries = dict(section.entries())
    for name, value in section.items():
        if name in without:
            continue
        dotted = f"{key}.{name}" if key else name
        if isinstance(value, Section):
            yield from _of_section(dotted, value)
        elif name in entries and value is not None and value != ():
            yield dotted, value, entries[name], None
        elif name == "kind":
            yield dotted, value, Name(f"kind of load: {', '.join(LOAD_KINDS)}"), None


def _of_effect(one: EffectSpec) -> Iterator[Placed]:
    entries = dict(EffectSpec.entries())
    for key in ("block", "kind", "dof", "relative_to", "actuator"):
        value = getattr(one, key)
        if value is not None:
            yield f"{one.name}.{key}", value, entries[key], None
    declared = one.law
    for name, value in one.parameters.items():
        entry = declared.parameters[name]
        unit = declared.unit(name, one.block)
        yield f"{one.name}.{name}", value, entry, unit
    for name, spread in one.uncertainty.items():
        yield f"{one.name}.uncertainty.{name}", spread, SPREAD, None


def parameter(name: str, value: Any, entry: Entry | Quantity | Text, unit: str | None = None) -> Parameter:
    """Return the parameter of an entry; an effect's entry needs its `unit`, as that may follow the block."""
    kind = entry.type if isinstance(entry, Entry) else "string" if isinstance(entry, Text) else "double"
    bounds = (getattr(entry, "lowest", None), getattr(entry, "highest", None))
    unit = getattr(entry, "unit", "") if unit is None else unit
    return Parameter(name, _stored(value), kind, unit, entry.description, *bounds, entry.allowed)


def _stored(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value
