"""The reference page of the spec: ``python -m rthm_core.spec.reference docs/reference/spec.md`` writes it."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rthm_core.effects import BLOCKS, Effect
from rthm_core.effects.blocks import PLACES, family
from rthm_core.effects.registry import shipped
from rthm_core.quantity import Quantity, Text
from rthm_core.spec.catalogue import sections
from rthm_core.spec.defaults import FILLED_IN
from rthm_core.spec.entries import Choice, Entry, Whole
from rthm_core.spec.load import LOAD_KINDS
from rthm_core.spec.sections import Section

HEAD = """# The spec, entry by entry

Written from the schema by `python -m rthm_core.spec.reference docs/reference/spec.md`; a test keeps it true.

A spec is a ROS 2 parameter file: every section below stands under `/**:`, `ros__parameters:`. Matrices are
row by row. Numbers are SI; `1`, `1.0` and `1e0` are the same number. Sections may be missing: a spec is a
whole loop (`plant`, `numerical`, `interface`, `actuator`, `timing`) or a `plant` alone.
"""

EFFECTS = """## Effects

Optional physics, by name. `effects` lists the names; each has a section of that name with `block`, `kind`,
the place where it sits and the parameters of its kind:

    effects: ["guide", "band"]
    guide: {block: "plant", kind: "coulomb_friction", dof: "x1", force: 0.05}
    band: {block: "motor", kind: "lag", actuator: "a1", time_constant: 0.003}

The place may be left out where there is only one. `uncertainty` within an effect of the plant or of a wire
says how well its parameters are known, as `uncertainty.plant` does for the mass: the diagnosis fits them.

    guide: {block: "plant", kind: "coulomb_friction", dof: "x1", force: 0.05, uncertainty: {force: 0.3}}

Kinds of one's own are declared in Python files (or modules), which `effects_from` lists; their paths count
from the folder of the spec (docs/how-to/add-an-effect.md). A file is executed by whoever reads the spec from
its path, nodes included, and by nobody who finds the spec in a recording.

    effects_from: ["cogging.py"]
"""

FAMILIES = {family(block): [one for one in BLOCKS if family(one) == family(block)] for block in BLOCKS}
"""Blocks of each family, which know the same kinds."""


def reference() -> str:
    """Return the page as Markdown."""
    return "\n".join([HEAD, *_sections(), EFFECTS, *_effects()])


def _sections() -> Iterator[str]:
    for key, section in sections():
        kind = next((kind for kind, of in LOAD_KINDS.items() if of is section), "")
        if key and list(section.entries()) and not (kind and key == "load.numerical"):
            title = f"## `load.plant` and `load.numerical`, kind `{kind}`" if kind else f"## `{key}`"
            yield f"{title}\n\n{_first(section)}\n"
            yield _table(["key", "unit", "allowed", "default", "what"], _entries(key, section))


def _first(of: type[Any]) -> str:
    """First paragraph of a class's docstring."""
    return " ".join((of.__doc__ or "").split("\n\n")[0].split()).replace("``", "`")


def _entries(key: str, section: type[Section]) -> Iterator[list[str]]:
    for name, entry in section.entries():
        default = section.model_fields[name].get_default()
        filled = FILLED_IN.get(f"{key}.{name}")
        shown = (
            "required"
            if section.model_fields[name].is_required()
            else ""
            if default is None
            else str(default)
        )
        yield [f"`{name}`", entry.unit, _allowed(entry), filled or shown, entry.description]


def _allowed(entry: Entry | Quantity | Text) -> str:
    if isinstance(entry, Quantity):
        return entry.bounds
    return entry.allowed.removeprefix("one of ") if isinstance(entry, Choice | Whole) else ""


def _effects() -> Iterator[str]:
    for blocks in FAMILIES.values():
        places = {PLACES[block]: block for block in reversed(blocks) if block in PLACES}
        yield f"### {', '.join(f'`{block}`' for block in blocks)}\n"
        if places:
            between = "; between two dofs with `relative_to` beside it" if "plant" in blocks else ""
            yield f"Place: {' or '.join(f'`{place}`' for place in reversed(places))}{between}.\n"
        declared = map(_kind, shipped(blocks[0]))
        yield _table(["kind", "what", "equation", "parameters"], declared)


def _kind(declared: type[Effect]) -> list[str]:
    return [
        f"`{declared.kind}`",
        _first(declared),
        f"`{declared.equation}`",
        "; ".join(_parameters(declared)),
    ]


def _parameters(declared: type[Effect]) -> Iterator[str]:
    for name, entry in declared.parameters.items():
        notes = [entry.description]
        if isinstance(entry, Quantity):
            unit = entry.unit.replace("signal", "unit of the signal")
            notes = [note for note in (unit if unit != "1" else "", entry.bounds, entry.description) if note]
            if entry.default is not None:
                notes.append(f"default {entry.default:g}")
        yield f"`{name}` ({', '.join(notes)})"


def _table(head: list[str], rows: Iterator[list[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(_cell(cell) for cell in line)} |" for line in lines) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(reference(), encoding="utf-8")
