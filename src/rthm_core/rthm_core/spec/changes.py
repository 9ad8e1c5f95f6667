"""Changed specs: sweeps, patches, scaled delays. A spec itself never changes."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from rthm_core.errors import refusal
from rthm_core.spec.load import LOAD_KINDS
from rthm_core.spec.parameters import parameters, spec_from_parameters
from rthm_core.spec.schema import Spec

_INDEXED = re.compile(r"(?P<name>.+)\[(?P<index>\d{1,9})\]")


def apply(spec: Spec, changes: Mapping[str, Any]) -> Spec:
    """Return the spec with other values.

    Parameters
    ----------
    changes
        Values by dotted name: ``{"timing.tau1": 0.005, "plant.mass[0]": 1.3, "guide.force": 0.1}``. A section may be given as a dict, a list
        of one by its number, None takes an entry or a section out. A new kind of load, or effects that are no longer listed, take their old
        entries with them.

    Raises
    ------
    InputError
        If a name is not known or a value not allowed.
    """
    flat: dict[str, Any] = {one.name: one.value for one in parameters(spec)}
    for name, value in _flattened(changes).items():
        _set(flat, name, value)
    listed = flat.get("effects", [])
    for one in spec.effects:
        if isinstance(listed, list | tuple) and one.name not in listed:
            _remove(flat, one.name)
    return spec_from_parameters(flat)


def _flattened(changes: Mapping[str, Any]) -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in changes.items():
        inner = _flattened(value) if isinstance(value, Mapping) else None
        flat.update({name: value} if inner is None else {f"{name}.{key}": one for key, one in inner.items()})
    return flat


def _set(flat: dict[str, Any], name: str, value: Any) -> None:
    indexed = _INDEXED.fullmatch(name)
    if indexed:
        _set_element(flat, indexed["name"], int(indexed["index"]), value)
    elif value is None:
        _remove(flat, name)
    else:
        if name in ("load.plant.kind", "load.numerical.kind") and value in LOAD_KINDS and flat.get(name) != value:
            _remove_other_entries(flat, name.removesuffix(".kind"))
        one_number = isinstance(flat.get(name), list) and len(flat[name]) == 1 and not isinstance(value, list | tuple)
        flat[name] = [value] if one_number and not hasattr(value, "tolist") or one_number and not getattr(value, "ndim", 0) else value


def _set_element(flat: dict[str, Any], name: str, index: int, value: Any) -> None:
    values = flat.get(name)
    if not isinstance(values, list) or index >= len(values):
        have = f"has {len(values)} elements" if isinstance(values, list) else "is no list of the spec"
        raise refusal(f"{name}[{index}]", value, f"an element that there is, and {name} {have}")
    flat[name] = [*values[:index], value, *values[index + 1 :]]


def _remove(flat: dict[str, Any], name: str) -> None:
    for key in [key for key in flat if key == name or key.startswith(f"{name}.")]:
        del flat[key]


def _remove_other_entries(flat: dict[str, Any], section: str) -> None:
    """Forget what belonged to the old kind of load."""
    for key in [key for key in flat if key.startswith(f"{section}.") and not key.endswith(".dof")]:
        del flat[key]


def scaled_timing(spec: Spec, factor: float) -> Spec:
    """Return the spec with every period and every delay of the loop multiplied by `factor`."""
    timing = spec.loop().timing
    return apply(spec, {f"timing.{name}": factor * value for name, value in timing.items()})
