"""The kinds of effects that are declared: where every part of the system finds them."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from string import Formatter
from typing import TypeVar

from rthm_core.effects.blocks import check_block, family
from rthm_core.effects.declaration import Change, Effect
from rthm_core.errors import RefusedError, suggestion

E = TypeVar("E", bound=type[Effect])

_EFFECTS: dict[tuple[str, str], type[Effect]] = {}


def register(declared: E) -> E:
    """Make a kind known in each of its families of blocks; a class decorator."""
    fields = {name for _, name, _, _ in Formatter().parse(declared.words) if name}
    unknown = fields - {*declared.parameters, "dof", "actuator", "block"}
    if unknown:
        raise TypeError(f"the words of {declared.kind} use {sorted(unknown)}, which are not parameters of it")
    for where in declared.blocks:
        if _EFFECTS.setdefault((where, declared.kind), declared) is not declared:
            raise TypeError(f"{declared.kind} is declared twice for {where}")
    return declared


@cache
def _load() -> None:
    """Import every module of this package, so that its kinds are registered."""
    for module in pkgutil.iter_modules([str(Path(__file__).parent)]):
        importlib.import_module(f"{__package__}.{module.name}")


def _load_installed() -> None:
    """Import every module of this package, and what installed packages announce, once."""
    _load()
    from rthm_core.effects.own import load_installed  # checks laws, which need the registry

    load_installed()


def declared() -> tuple[type[Effect], ...]:
    """Every kind that is known now, shipped or not."""
    _load()
    return tuple(dict.fromkeys(_EFFECTS.values()))


def forget(some: Iterable[type[Effect]]) -> None:
    """Take kinds out that were registered by what then failed."""
    gone = set(some)
    for key in [key for key, one in _EFFECTS.items() if one in gone]:
        del _EFFECTS[key]


def shipped(block: str) -> tuple[type[Effect], ...]:
    """Kinds of a block, or of a family of blocks, that come with this package, in alphabetical order."""
    here = (one for one in declared() if one.__module__.startswith(f"{__package__}."))
    return tuple(sorted((one for one in here if family(block) in one.blocks), key=lambda one: one.kind))


def kinds(block: str) -> tuple[str, ...]:
    """Kinds of effect that `block` can have, in alphabetical order."""
    check_block(block)
    _load_installed()
    return tuple(sorted(kind for where, kind in _EFFECTS if where == family(block)))


def own_laws(block: str) -> tuple[type[Effect], ...]:
    """Kinds of `block` that somebody else than this package declares."""
    known = shipped(block)
    return tuple(one for one in (effect(kind, block) for kind in kinds(block)) if one not in known)


def ranked(block: str, shown_by: str = "") -> tuple[type[Effect], ...]:
    """Kinds that `block` can have, in the order in which a search tries them: those that are always looked
    for, or where a free curve over a variable was told.
    """
    found = (one for one in (effect(kind, block) for kind in kinds(block)) if one.shown_by == shown_by)
    return tuple(sorted(found, key=lambda one: (one.rank, one.kind)))


def changing(block: str, what: Change) -> type[Effect]:
    """The shipped kind that changes this of `block`."""
    return next(one for one in shipped(block) if one.changes == what)


def effect(kind: str, block: str) -> type[Effect]:
    """Effect of a `kind` in a `block`.

    Raises
    ------
    RefusedError
        If the block is not known or has no such kind; names those that it has.
    """
    check_block(block)
    _load()
    found = _EFFECTS.get((family(block), kind))
    if found is None:
        known = kinds(block)
        found = _EFFECTS.get((family(block), kind))
    if found is None:
        allowed = f"a kind that {block} knows ({', '.join(known)})"
        raise RefusedError(kind, allowed, suggestion(str(kind), known), "kind")
    return found
