"""Entries of a spec as they stand at an axis: with their units."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rthm_core.effects import BLOCKS, effect, kinds
from rthm_core.spec.catalogue import entry_at

if TYPE_CHECKING:
    pass


def label(key: str) -> str:
    """Key with its unit, as ``timing.tau4 (s)``; bare where the unit is not known.

    Examples
    --------
    >>> label("actuator.stiffness[0]")
    'actuator.stiffness[0] (N/m)'
    >>> label("guide.static_force")
    'guide.static_force (N)'
    >>> label("timing.scale")
    'timing.scale (factor on all periods and delays)'
    """
    if key == "timing.scale":
        return f"{key} (factor on all periods and delays)"
    bare = key.partition("[")[0]
    entry = entry_at(bare)
    unit = entry.unit if entry is not None else _of_effects(bare.rpartition(".")[2])
    return f"{key} ({unit})" if unit else key


def _of_effects(name: str) -> str:
    """Unit of a parameter of effects; empty where kinds differ in it."""
    every = ((block, effect(kind, block)) for block in BLOCKS for kind in kinds(block))
    units = {one.unit(name, block) for block, one in every if name in one.parameters} - {""}
    return units.pop() if len(units) == 1 else ""
