"""From values by dotted name to a checked spec."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from pydantic import ValidationError

from rthm_core.effects.own import KEY, not_loaded
from rthm_core.errors import MISSING, InputError, RefusedError, printable, refusal, unknown
from rthm_core.spec.catalogue import ROOT
from rthm_core.spec.defaults import completed
from rthm_core.spec.effect import HEAD, from_section
from rthm_core.spec.messages import input_error
from rthm_core.spec.schema import Spec


def spec_from_parameters(
    given: Mapping[str, Any], besides: Collection[str] = (), built: Mapping[str, Any] | None = None
) -> Spec:
    """Return the spec that ROS parameters describe.

    Parameters
    ----------
    given
        Values by dotted name.
    besides
        Names that are no part of a spec and are passed over, such as a node's own parameters.
    built
        Sections of another spec, by name, that are part of this one as they are.

    Raises
    ------
    InputError
        On the first thing that is not allowed.
    """
    tree = nested({name: value for name, value in given.items() if name not in besides})
    gathered = completed(_with_effects(tree) | dict(built or {}))
    try:
        return Spec.model_validate(gathered)
    except ValidationError as error:
        raise _told(input_error(error, gathered), gathered) from None


def _told(error: InputError, tree: Mapping[str, Any]) -> InputError:
    """An error; where a kind is not known and files of effects were not loaded, with the way to them."""
    named = tree.get(KEY)
    missing = not_loaded(named) if isinstance(named, list | tuple) else ()
    if not missing or ".kind is " not in str(error):
        return error
    return InputError(
        f"{str(error).rpartition(';')[0]}; {KEY} names {missing[0]}, which is executed only where you name "
        f"it yourself: give --effects {missing[0]}, or rthm.load(..., effects=...), if you trust it."
    )


def nested(flat: Mapping[str, Any]) -> dict[str, Any]:
    """Sections within sections from dotted names."""
    tree: dict[str, Any] = {}
    for name, value in flat.items():
        *path, last = name.split(".")
        if value is None:
            raise refusal(name, value, "a value", "give one, or remove the key")
        if "" in (*path, last):
            raise refusal(
                name, value, "left out, as its name has an empty part", "correct the dots in the name"
            )
        section = tree
        for part in path:
            section = section.setdefault(part, {})
            if not isinstance(section, dict):
                raise refusal(
                    name.rpartition(".")[0], section, f"a section, as {printable(name)} is given too"
                )
        if last in section:
            raise refusal(name, value, "a section, as entries of it are given too")
        section[last] = value
    return tree


def _with_effects(tree: dict[str, Any]) -> dict[str, Any]:
    """Move the sections of effects into the list of effects."""
    names = tree.get("effects", [])
    if not isinstance(names, list | tuple) or not all(isinstance(name, str) for name in names):
        raise refusal("effects", names, "a list of names, each with a section of that name")
    for name in names:
        _check_name(name)
    sections = {key: value for key, value in tree.items() if key not in ROOT}
    for key, value in sections.items():
        if key not in names:
            raise _stray(key, value)
    effects = [_effect(name, sections.get(name, MISSING)) for name in names]
    return {key: value for key, value in tree.items() if key in ROOT} | {"effects": effects}


def _check_name(name: str) -> None:
    if name in ROOT or not name.isascii() or not name.isidentifier() or len(name) > 60:
        allowed = "names of letters, digits and _ that are no section of the spec"
        raise refusal("effects", name, allowed, "rename the effect")


def _effect(name: str, section: Any) -> dict[str, Any]:
    if not isinstance(section, dict):
        allowed = f"a section with {', '.join(HEAD[:2])}, its place and its parameters"
        raise refusal(name, section, allowed, f"add it, or take {name} out of effects")
    try:
        return from_section(name, section)
    except RefusedError as refused:
        raise refused.at(name) from None


def _stray(key: str, value: Any) -> InputError:
    if isinstance(value, dict) and ("kind" in value or "block" in value):
        allowed = f"a list with {printable(key)}, which has a section"
        return refusal("effects", MISSING, allowed, "add it to the list")
    return unknown(key, value, ROOT)
