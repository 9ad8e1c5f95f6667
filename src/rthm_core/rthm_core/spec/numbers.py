"""Every single number of a spec, by name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rthm_core.quantity import Quantity
from rthm_core.spec.entries import Number
from rthm_core.spec.schema import Spec
from rthm_core.spec.sections import Section


def numbers(spec: Spec) -> dict[str, Quantity]:
    """Every single number of a spec with its unit and bounds.

    Elements of lists are named ``plant.mass[0]``, the element of a list of one also ``plant.mass``.
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
