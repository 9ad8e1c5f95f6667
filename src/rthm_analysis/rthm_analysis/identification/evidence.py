"""What a recording says of one actuator and its dof: channels over time, and the commands it was given."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.recording import rows_of
from rthm_core.clock import NS
from rthm_core.topics import COMMAND

if TYPE_CHECKING:
    from rthm_analysis.recording import Recording
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


@dataclass(frozen=True)
class Motion:
    """An actuator that moves its dof. Times in s since the start, values in SI; NaN: not measured.

    Attributes
    ----------
    actuator, dof
        Names.
    time, motor, force, position, velocity : (s,) arrays
        Samples of the plant.
    command_time, command : (c,) arrays
        When each command was used, as far as the driver tells it, else its stamp; and its value.
    waited
        Mean time from the stamp of a command to its use, s; None where the driver tells no use.
    """

    actuator: str
    dof: str
    time: Floats
    motor: Floats
    force: Floats
    position: Floats
    velocity: Floats
    command_time: Floats
    command: Floats
    waited: float | None = None


def motions_of(recording: Recording, spec: Spec) -> list[Motion]:
    """All actuators of a recorded test."""
    loop, plant = spec.loop(), recording.plant
    names, dofs = loop.actuator.names, loop.interface.plant_dof
    time = np.asarray(recording.seconds(plant.stamp_ns))
    used, command, waited = _commands(recording, names)

    def columns(field: str, of: tuple[str, ...]) -> Floats:
        return plant.columns(field, of).T

    channels = columns("position", names), columns("effort", names)
    moved = columns("position", dofs), columns("velocity", dofs)
    return [
        Motion(name, dof, time, motor, force, x, v, used, command[:, i], waited)
        for i, (name, dof, motor, force, x, v) in enumerate(zip(names, dofs, *channels, *moved, strict=True))
    ]


def _commands(recording: Recording, names: tuple[str, ...]) -> tuple[Floats, Floats, float | None]:
    """Instants (c,) at which commands were used, the commands (c, m), and how long they waited."""
    table = recording.tables.get(COMMAND)
    if table is None:
        return np.empty(0), np.empty((0, len(names))), None
    values, link = table.columns("position", names), recording.links.get("tau4")
    if link is None:
        return np.asarray(recording.seconds(table.stamp_ns)), values, None
    row, known = rows_of(table.stamp_ns, link.sample_ns)
    waited = float(np.mean(link.use_ns[known] - link.sample_ns[known])) / NS
    return np.asarray(recording.seconds(link.use_ns[known])), values[row[known]], waited
