"""A constant force beside one that no kind states: it may be the constant part of that one."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.criteria.verdict import CONSTANT_PART_SHARE
from rthm_analysis.diagnosis.numbers import bare, number
from rthm_analysis.diagnosis.result import Described, Physics, Value
from rthm_core.effects import effect


def with_constant_parts(
    physics: Iterable[Physics], forces: Iterable[Described]
) -> tuple[list[Physics], tuple[Described, ...]]:
    """Physics without the constant forces that are no physics of their own, and the forces that hold them.

    What depends on the position in a way that is not known may be anything where the dof rests: a constant
    that is not much larger is as well a part of it. Beside dry friction its other meanings are told
    (`inseparable`).

    Parameters
    ----------
    physics : iterable of Physics
        What was named.
    forces : iterable of Described
        What is left beside it.
    """
    kept, whole = list(physics), list(forces)
    rubbing = {one.place for one in kept if one.block == "plant" and effect(one.kind, "plant").jump}
    for one in list(kept):
        size = _constant(one)
        holding = [k for k, force in enumerate(whole) if size is not None and _may_hold(force, one, size)]
        if size is not None and holding and one.place not in rubbing:
            kept.remove(one)
            whole[holding[0]] = _together(whole[holding[0]], size, one.share)
    return kept, tuple(whole)


def _constant(one: Physics) -> Value | None:
    """Force of a constant force of the plant."""
    if one.block != "plant" or effect(one.kind, "plant").power != 0:
        return None
    value = next(iter(one.parameters.values()))
    return value if isinstance(value, Value) else None


def _may_hold(force: Described, one: Physics, size: Value) -> bool:
    """Whether a force that was described may hold this constant."""
    return (
        (force.block, force.place) == (one.block, one.place)
        and "x" in force.depends_on
        and float(np.abs(force.force).max(initial=0.0)) > CONSTANT_PART_SHARE * abs(size.value)
    )


def _together(force: Described, size: Value, share: float) -> Described:
    """A force with its constant part, which has shown on unseen data what it explains there."""
    words = (
        f"{force.words} The model holds it beside a constant force of "
        f"{number(size.value, size.std, size.unit, signed=True)} there, which may be part of it."
    )
    formula = None if force.formula is None else f"{bare(size.value)} + {force.formula}"
    law = None if force.law is None else (force.law[0], force.law[1] + size.value)
    return replace(
        force,
        words=words,
        formula=formula,
        law=law,
        force=force.force + size.value,
        held_out_gain=max(force.held_out_gain, share),
    )
