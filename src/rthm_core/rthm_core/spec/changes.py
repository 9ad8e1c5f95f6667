"""Changed specs: sweeps, patches, scaled delays. A spec itself never changes."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from numbers import Real
from pathlib import Path
from typing import Any

from rthm_core.errors import refusal
from rthm_core.spec.building import spec_from_parameters
from rthm_core.spec.catalogue import ROOT
from rthm_core.spec.checks import check_delays
from rthm_core.spec.parameters import values
from rthm_core.spec.schema import Spec

PLACE_KEYS = ("block", "dof", "relative_to", "actuator")
_INDEXED = re.compile(r"(?P<name>.+)\[(?P<index>\d{1,9})\]")


def apply(spec: Spec, changes: Mapping[str, Any]) -> Spec:
    """Return the spec with other values.

    Parameters
    ----------
    changes
        Values by dotted name: ``{"timing.tau1": 0.005, "plant.mass[0]": 1.3, "guide.force": 0.1}``. A
        section may be given as a dict, a list of one as its number; None takes an entry or a section out.
        What belonged to a load of another kind or to effects that are no longer listed goes by itself. A
        stiffness of the actuators takes out the transmission, which would replace it.

    Raises
    ------
    InputError
        If a name is not known or a value not allowed.
    """
    changed = _flattened(changes)
    kept = _untouched(spec, changed)
    flat = values(spec, without=kept)
    _make_way(flat, changed, spec)
    for name, value in changed.items():
        _set(flat, name, value)
    listed = flat.get("effects", [])
    for one in spec.effects:
        if isinstance(listed, list | tuple) and one.name not in listed:
            _remove(flat, one.name)
    return spec_from_parameters(flat, built=kept)


def _untouched(spec: Spec, changed: Mapping[str, Any]) -> dict[str, Any]:
    """Sections in which nothing changes. They are the same objects in the new spec: what follows from them
    alone is known by their identity (`rthm_core.kept`), and they are not checked again.
    """
    touched = {re.split(r"[.\[]", name, maxsplit=1)[0] for name in changed}
    if not touched <= set(ROOT) or "effects_from" in touched:
        touched.add("effects")  # an effect has a section of its own, whose kind a file may declare
    return {name: value for name, value in spec.items() if name not in touched and value is not None}


def with_effects_from(spec: Spec, loaded: Sequence[str]) -> Spec:
    """Return the spec with further files or modules, loaded before, that declare kinds of effects.

    A file takes the place of one of the same name in another folder: a recording names its files as they were
    where it was made.
    """
    names = {Path(one).name for one in loaded}
    kept = [one for one in spec.effects_from if Path(one).name not in names]
    return apply(spec, {"effects_from": [*kept, *loaded]}) if loaded else spec


def number_at(spec: Spec, name: str) -> float | None:
    """Number that a spec has under a dotted name; None for what is no single number of it."""
    indexed = _INDEXED.fullmatch(name)
    value = values(spec).get(indexed["name"] if indexed else name)
    if isinstance(value, list):
        index = int(indexed["index"]) if indexed else 0
        value = value[index] if index < len(value) and (indexed or len(value) == 1) else None
    return float(value) if isinstance(value, int | float) else None


def _flattened(changes: Mapping[str, Any]) -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in changes.items():
        inner = _flattened(value) if isinstance(value, Mapping) else None
        flat.update({name: value} if inner is None else {f"{name}.{key}": one for key, one in inner.items()})
    return flat


def _make_way(flat: dict[str, Any], changed: dict[str, Any], spec: Spec) -> None:
    """Remove what a change makes meaningless: entries of the old kind, a transmission beside a new k_tot."""
    for name, value in changed.items():
        if name.endswith(".kind") and flat.get(name, value) != value:
            section = name.removesuffix(".kind")
            kept = {f"{section}.{key}" for key in PLACE_KEYS}
            for key in [key for key in flat if key.startswith(f"{section}.") and key not in kept]:
                del flat[key]
    if any(name.partition("[")[0] == "actuator.stiffness" for name in changed):
        _remove(flat, "actuator.transmission")
        flat["actuator.stiffness"] = list(spec.k_tot)


def _set(flat: dict[str, Any], name: str, value: Any) -> None:
    indexed = _INDEXED.fullmatch(name)
    if indexed:
        _set_element(flat, indexed["name"], int(indexed["index"]), value)
    elif value is None:
        _remove(flat, name)
    else:
        flat[name] = [value] if _is_only_element(flat.get(name), value) else value


def _is_only_element(old: Any, new: Any) -> bool:
    """Whether a lone number or name is meant for a list that has one element."""
    return isinstance(old, list) and len(old) == 1 and isinstance(new, Real | str)


def _set_element(flat: dict[str, Any], name: str, index: int, value: Any) -> None:
    old = flat.get(name)
    if not isinstance(old, list) or index >= len(old):
        have = f"{len(old)} elements" if isinstance(old, list) else "no elements"
        raise refusal(f"{name}[{index}]", value, f"an element that there is, and {name} has {have}")
    flat[name] = [*old[:index], value, *old[index + 1 :]]


def _remove(flat: dict[str, Any], name: str) -> None:
    for key in [key for key in flat if key == name or key.startswith(f"{name}.")]:
        del flat[key]


def with_timing(spec: Spec, other: Spec) -> Spec:
    """Return the spec with the periods and delays of another one that has the same sections.

    Raises
    ------
    RefusedError
        If an effect takes more off a delay than there is.
    """
    changed = spec.model_copy(update={"timing": other.timing})
    check_delays(changed)  # the one thing that both sections know of each other
    return changed


def scaled_timing(spec: Spec, factor: float) -> Spec:
    """Return the spec with every period and every delay of the loop multiplied by `factor`."""
    timing = spec.loop().timing
    return apply(spec, {f"timing.{name}": factor * value for name, value in timing.items()})
