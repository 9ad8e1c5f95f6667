"""A named spring or constant force beside a force that no kind states: it may be a part of that one."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.verdict import CONSTANT_PART_SHARE
from rthm_analysis.diagnosis.numbers import bare, number
from rthm_analysis.diagnosis.result import Described, Physics, Value
from rthm_analysis.diagnosis.search.judging import Selection
from rthm_core.compiled import Floats
from rthm_core.effects import effect


class Part(NamedTuple):
    """A force ``size x^power`` of the plant that was named."""

    physics: Physics
    size: Value
    power: int

    @property
    def words(self) -> str:
        """What it is, with its size."""
        size = number(self.size.value, self.size.std, self.size.unit, signed=True)
        return f"a constant force of {size}" if self.power == 0 else f"F = ({size}) * x**{self.power}"

    @property
    def formula(self) -> str:
        """Its force as a term of a formula."""
        return bare(self.size.value) + (f" * x**{self.power}" if self.power else "")

    def force(self, x: Floats) -> Floats:
        """Its force at some positions, N."""
        return np.asarray(self.size.value * x**self.power)


def with_parts(
    physics: Iterable[Physics], forces: Iterable[Described], over_position: Collection[str] = ()
) -> tuple[list[Physics], tuple[Described, ...]]:
    """Physics without forces that are no physics of their own, and the forces that hold them.

    What depends on the position in a way that is not known may be anything where the dof rests: a constant
    that is not much larger is as well a part of it. A formula with a term of the position alone and a power
    of the position are one law, of which nobody knows how it is to be divided. Beside dry friction the other
    meanings of a constant are told (`inseparable`).

    Parameters
    ----------
    physics : iterable of Physics
        What was named.
    forces : iterable of Described
        What is left beside it.
    over_position : collection of str
        Dofs at which a formula has a term of the position alone.
    """
    kept, whole = list(physics), list(forces)
    rubbing = {one.place for one in kept if one.block == "plant" and effect(one.kind, "plant").jump}
    for part in filter(None, map(_part, list(kept))):
        if part.power == 0 and part.physics.place in rubbing:
            continue
        holding = next((k for k, force in enumerate(whole) if _may_hold(force, part, over_position)), None)
        if holding is not None:
            kept.remove(part.physics)
            whole[holding] = _together(whole[holding], part)
    return kept, tuple(whole)


def over_position(selection: Selection) -> set[str]:
    """Dofs at which a formula of a model has a term of the position alone."""
    terms = [one for one in selection.best.model.added if one.block == "plant" and one.law.written]
    return {one.place for one in terms if tuple(one.law.depends_on) == ("x",)}


def _part(one: Physics) -> Part | None:
    """The force that was named as a power of the position; None where it is no such force."""
    power = effect(one.kind, "plant").power if one.block == "plant" else None
    size = next(iter(one.parameters.values()), None)
    if power is None or not isinstance(size, Value):
        return None
    towards = 1.0 if power == 0 else -1.0  # a spring pulls back
    return Part(one, replace(size, value=towards * size.value), power)


def _may_hold(force: Described, part: Part, over_position: Collection[str]) -> bool:
    """Whether a force that was described may hold a part."""
    if (force.block, force.place) != (part.physics.block, part.physics.place) or "x" not in force.depends_on:
        return False
    if part.power:
        return force.formula is not None and force.place in over_position
    largest = float(np.abs(force.force).max(initial=0.0))
    return largest > CONSTANT_PART_SHARE * abs(part.size.value)


def _together(force: Described, part: Part) -> Described:
    """A force with its part, which has shown on unseen data what it explains there."""
    words = f"{force.words} The model holds it beside {part.words} there, which may be part of it."
    formula = None if force.formula is None else f"{part.formula} + {force.formula}".replace("+ -", "- ")
    over_x = part.power == 0 or force.depends_on[0] == "x"
    law = None if force.law is None else (force.law[0], force.law[1] + part.force(force.law[0]))
    return replace(
        force,
        words=words,
        formula=formula,
        law=law if over_x else force.law,
        force=force.force + part.force(force.at) if over_x else force.force,
        held_out_gain=max(force.held_out_gain, part.physics.share),
    )
