"""What a spec may leave out because there is only one sensible value."""

from __future__ import annotations

from typing import Any

from rthm_core.effects.blocks import PLACES

FILLED_IN = {
    "plant.initial_velocity": "zeros",
    "numerical.initial_position": "zeros",
    "numerical.initial_velocity": "zeros",
    "actuator.pretension": "zeros",
    "load.plant.dof": "the only dof",
    "load.numerical.dof": "the only dof",
}
"""Entries that `completed` gives a value to, in words."""


def completed(tree: dict[str, Any]) -> dict[str, Any]:
    """Return the sections with such values filled in; what is wrong stays, for the checks to tell, and so
    does a section that is built already.
    """
    done = {key: dict(value) if isinstance(value, dict) else value for key, value in tree.items()}
    plant, numerical, actuator = done.get("plant"), done.get("numerical"), done.get("actuator")
    _zeros(plant, "dofs", "initial_velocity")
    _zeros(numerical, "dofs", "initial_position", "initial_velocity")
    _zeros(actuator, "names", "pretension")
    dofs = {"plant": _names(plant, "dofs"), "numerical": _names(numerical, "dofs")}
    done["load"] = _loads(done.get("load", {}), dofs)
    places = {"dof": dofs["plant"], "actuator": _names(actuator, "names")}
    done["effects"] = [
        _placed(dict(one), places) if isinstance(one, dict) else one for one in done["effects"]
    ]
    return done


def _names(section: Any, key: str) -> list[Any]:
    names = section.get(key) if isinstance(section, dict) else getattr(section, key, None)
    return list(names) if isinstance(names, list | tuple) else []


def _zeros(section: Any, names: str, *keys: str) -> None:
    if isinstance(section, dict):
        for key in keys:
            section.setdefault(key, [0.0] * len(_names(section, names)))


def _loads(loads: Any, dofs: dict[str, list[Any]]) -> Any:
    """No load where none is given; the only dof where none is named."""
    if not isinstance(loads, dict):
        return loads
    done = dict(loads)
    for side, names in dofs.items():
        load = done.get(side, {"kind": "none"} if names else None)
        if isinstance(load, dict) and names and (len(names) == 1 or load.get("kind") == "none"):
            load = {"dof": names[0], **load}
        if load is not None or side in done:
            done[side] = load
    return done


def _placed(one: Any, places: dict[str, list[Any]]) -> Any:
    """Put an effect at the only dof or actuator there is."""
    if not isinstance(one, dict):
        return one
    block = one.get("block")
    key = PLACES.get(block) if isinstance(block, str) else None
    only = {key: places[key][0]} if key and key not in one and len(places[key]) == 1 else {}
    return one | only
