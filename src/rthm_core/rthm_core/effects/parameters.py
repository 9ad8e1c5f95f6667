"""Blocks that compute: what they compute with is exact by definition, so a different value there is an effect."""

from __future__ import annotations

from rthm_core.effects.base import Effect, EffectParameter, EffectText, register


@register
class WrongParameter(Effect):
    """A spec entry that the block computes with, but with another value."""

    kind = "wrong_parameter"
    blocks = ("numerical", "controller")
    parameters = {
        "name": EffectText("spec entry that is wrong in this block, such as actuator.stiffness or numerical.mass[0]"),
        "value": EffectParameter("1", "value that the block computes with, in the unit of that entry"),
    }
    equation = "entry = value, in this block only"
    words = "the {block} computes with {value} for {name}"
