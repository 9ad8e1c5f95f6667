"""What is wrong with a block that computes: another value than the spec's.

What the controller and the numerical substructure compute with is exact by definition, so this is not
uncertainty.
"""

from __future__ import annotations

from rthm_core.effects.declaration import Effect, EffectParameter, EffectText
from rthm_core.effects.registry import register


@register
class WrongParameter(Effect):
    """A spec entry that the block computes with, but with another value."""

    kind = "wrong_parameter"
    blocks = ("numerical", "controller")
    parameters = {
        "name": EffectText(
            "spec entry that this block has wrong, as actuator.stiffness or numerical.mass[0]"
        ),
        "value": EffectParameter("1", "value that the block computes with, in the unit of that entry"),
    }
    equation = "entry = value, in this block only"
    words = "the {block} computes with {value} for {name}"
    experiment = (
        "Compare the parameters that the node was started with (`ros2 param dump`) with the "
        "spec: {name} differs. No test of the rig is needed for that."
    )
    changes = "entry"
    linear = True
