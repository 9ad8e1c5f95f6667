"""Compensators: how the controller predicts what its delayed samples will have become when the motor acts on
them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_core.compiled import Floats, copy_into, inlined
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_core.spec import Spec

NONE = 0
CODES = {"none": NONE}


def compensator_code(spec: Spec) -> tuple[int, Floats]:
    """Code and settings of the compensator that a spec asks for.

    Raises
    ------
    InputError
        When there is no compensator of this name.
    """
    name = str(spec.loop().actuator.compensator)
    if name not in CODES:
        raise InputError(
            f"actuator.compensator {name!r} is not available, allowed is one of "
            f"{', '.join(CODES)}; choose one of them."
        )
    return CODES[name], np.empty(0)


@inlined
def compensated(controller, now, position, force):  # type: ignore[no-untyped-def]
    """Write the plant position (m,) and the force reference (m,) that the controller acts on."""
    copy_into(position, controller.position[0])
    copy_into(force, controller.force[0])
