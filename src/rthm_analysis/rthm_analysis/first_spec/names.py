"""Which names of a recording are dofs, which are actuators, and whether it is of a loop."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_core.errors import InputError
from rthm_core.topics import COMMAND, FORCE_REFERENCE, NUMERICAL_STATE

if TYPE_CHECKING:
    from rthm_analysis.recording import Recording
    from rthm_core.compiled import Floats

LOOP = (NUMERICAL_STATE, FORCE_REFERENCE, COMMAND)
"""Topics without which a recording is one of a plant alone."""

ACTUATOR = re.compile(r"a\d+")
"""Names that actuators usually have, as dofs have ``x1``."""

KNOWN = 0.5
"""Share of the samples of a signal that is recorded."""


@dataclass(frozen=True)
class Parts:
    """Names of the parts of a test.

    Attributes
    ----------
    dofs : tuple of str
        Of the plant.
    numerical : tuple of str
        Dofs of the numerical substructure; empty for a plant alone.
    actuators : tuple of str
        Of a loop; names of known forces beside a plant alone.
    """

    dofs: tuple[str, ...]
    numerical: tuple[str, ...]
    actuators: tuple[str, ...]

    @property
    def is_loop(self) -> bool:
        """Whether all parts of a hybrid test were recorded."""
        return bool(self.numerical)


def parts_of(recording: Recording, dofs: Sequence[str] = ()) -> Parts:
    """Tell the parts of a recorded test by their names.

    Parameters
    ----------
    recording : Recording
    dofs : sequence of str
        Which names of the plant are dofs; none: to be told by what was recorded of them.

    Raises
    ------
    InputError
        If a name is not recorded, none is a dof, or forces act on a plant of several dofs and nothing says
        where.
    """
    plant = recording.plant
    for name in dofs:
        if name not in plant.names:
            raise InputError(
                f"--dof is {name}, but must be one of the names in plant/state, {', '.join(plant.names)}; "
                "correct it."
            )
        if not any(_is_known(plant.columns(field, [name])) for field in ("position", "velocity")):
            raise InputError(
                f"--dof is {name}, of which neither position nor velocity is recorded; name one that moves."
            )
    if all(topic in recording.tables for topic in LOOP):
        actuators = recording.tables[COMMAND].names
        found = tuple(dofs) or tuple(name for name in plant.names if name not in actuators)
        return Parts(_some(found, recording), recording.tables[NUMERICAL_STATE].names, actuators)
    moving = [name for name in plant.names if _is_known(plant.columns("position", [name]))]
    moving += [
        name for name in plant.names if name not in moving and _is_known(plant.columns("velocity", [name]))
    ]
    likely = [name for name in moving if not ACTUATOR.fullmatch(name)] or moving
    found = _some(tuple(dofs) or tuple(likely), recording)
    forces = tuple(name for name in plant.names if name not in found)
    if forces and len(found) > 1:
        raise InputError(
            f"{', '.join(forces)} of plant/state must be forces on one of {', '.join(found)}, and nothing "
            "says on which; import them as loads of a dof (--map load:x1=COLUMN), or name all dofs (--dof)."
        )
    return Parts(found, (), forces)


def _some(dofs: tuple[str, ...], recording: Recording) -> tuple[str, ...]:
    if not dofs:
        raise InputError(
            f"{recording.path} has no position or velocity in plant/state, only "
            f"{', '.join(recording.plant.names) or 'no names'}; record the motion of the plant."
        )
    return dofs


def _is_known(values: Floats) -> bool:
    return bool(np.isfinite(values).mean() > KNOWN)
