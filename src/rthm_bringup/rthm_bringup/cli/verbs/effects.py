"""``rthm effects``: the physics that a spec may add to a test."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rthm_bringup.cli.options import Effects, Json

if TYPE_CHECKING:
    from rthm_core.effects import Effect

EXAMPLES = (
    "rthm effects",
    "rthm effects coulomb_friction",
)


def verb(
    kind: Annotated[
        str | None, typer.Argument(metavar="[KIND]", help="Show the equation and parameters of this kind.")
    ] = None,
    effects: Effects = None,
    json: Json = None,
) -> int:
    """List the effects that a spec may add, or show one in full."""
    from rthm_bringup.cli.output import put
    from rthm_core.effects import load_effects

    load_effects(effects or ())
    found = list(_found(kind))
    if not found:
        _refuse(str(kind))
    lines = _list(found) if kind is None else [line for one in found for line in _whole(*one)]
    put({"effects": [_entry(*one) for one in found]}, lines, json)
    return 0


def _found(kind: str | None) -> Iterator[tuple[str, type[Effect]]]:
    """Blocks and their effects, of one kind or of all; a link stands for the four, a sensor for the three."""
    from rthm_core.effects import BLOCKS, effect, kinds
    from rthm_core.effects.blocks import family

    seen: set[str] = set()
    for block in BLOCKS:
        if family(block) in seen:
            continue
        seen.add(family(block))
        yield from ((family(block), effect(one, block)) for one in kinds(block) if kind in (None, one))


def _refuse(kind: str) -> None:
    from rthm_core.errors import InputError, suggestion

    near = suggestion(kind, sorted({one.kind for _, one in _found(None)}))
    raise InputError(f"there is no effect {kind!r}; {near or 'rthm effects lists all of them'}.")


def _about(one: type[Effect]) -> str:
    return " ".join((one.__doc__ or "").split("\n\n")[0].split())


def _list(found: list[tuple[str, type[Effect]]]) -> list[str]:
    width = max(len(one.kind) for _, one in found)
    lines, before = [], ""
    for block, one in found:
        if block != before:
            lines += ["", block] if before else [block]
            before = block
        lines.append(f"  {one.kind.ljust(width)}  {_about(one)}")
    return lines


def _whole(block: str, one: type[Effect]) -> list[str]:
    from rthm_bringup.cli.output import table

    rows = [
        (f"  {name}", *(entry.get("unit", ""), entry["description"]))
        for name, entry in _entry(block, one)["parameters"].items()
    ]
    return [
        f"{block}: {one.kind}",
        f"  {_about(one)}",
        *([f"  {one.equation}"] if one.equation else []),
        *table(rows),
    ]


def _entry(block: str, one: type[Effect]) -> dict[str, Any]:
    parameters = {
        name: {"unit": getattr(entry, "unit", ""), "description": entry.description}
        for name, entry in one.parameters.items()
    }
    return {
        "block": block,
        "kind": one.kind,
        "words": _about(one),
        "equation": one.equation,
        "parameters": parameters,
    }
