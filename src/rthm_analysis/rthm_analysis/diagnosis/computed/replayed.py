"""What a controller computes from the samples that it used, whatever its compensator."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.diagnosis.links.stamps import stamp_offset
from rthm_analysis.recording import Recording, Table, rows_of
from rthm_analysis.timing.links import SOURCES
from rthm_analysis.timing.recorded import RecordedSchedule
from rthm_core.controller import HISTORY, Controller
from rthm_core.errors import InputError
from rthm_core.schedule import INITIAL
from rthm_core.topics import COMMAND, FORCE_REFERENCE

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec import Spec


class Predicted(NamedTuple):
    """Both terms of commands as predicted: x1 (n, m), m, and F_d (n, m), N; NaN: not known."""

    position: Floats
    force: Floats


@dataclass(frozen=True)
class Used:
    """Samples that a controller used, in the order of its commands.

    Attributes
    ----------
    time : (n,) array
        Instants of the commands, ns after the start.
    recorded : (n,) array
        Row of each of them among the recorded commands; -1: it is not recorded.
    state_stamp, force_stamp : (n,) arrays
        Stamps of the newest state and reference, ns after the start; negative: still the initial one.
    motion, force : (n, 2 m), (n, m) arrays
        [x1, v1] and F_d of these; NaN: not recorded.
    """

    time: Integers
    recorded: Integers
    state_stamp: Integers
    motion: Floats
    force_stamp: Integers
    force: Floats

    def part(self, begin: int, end: int) -> Used:
        """Return some of the commands."""
        return Used(*(column[begin:end] for column in self.__dict__.values()))

    def predicted(self, spec: Spec) -> Predicted:
        """What the controller of a spec makes of these samples."""
        controller, m = Controller(spec), self.force.shape[1]
        stiffness = controller.compiled.stiffness
        position, force = np.full((2, self.time.size, m), np.nan)
        state, reference = -1, -1
        for row, now in enumerate(self.time.tolist()):
            if self.state_stamp[row] > state:
                state = int(self.state_stamp[row])
                controller.latch_state(state, self.motion[row, :m], self.motion[row, m:])
            if self.force_stamp[row] > reference:
                reference = int(self.force_stamp[row])
                controller.latch_force(reference, self.force[row])
            command = controller.command(now)
            force[row] = controller.force
            position[row] = command - force[row] / stiffness
        return Predicted(position, force)

    @property
    def settled(self) -> int:
        """First command before which a controller has forgotten what it began with."""
        states, references = (
            np.unique(s, return_index=True)[1] for s in (self.state_stamp, self.force_stamp)
        )
        return int(max(first[min(HISTORY, first.size - 1)] for first in (states, references)))


class _AsTold(RecordedSchedule):
    """Recorded schedule in which stamps of other clocks are those of the senders."""

    def __init__(self, spec: Spec, recording: Recording) -> None:
        self._offsets = {
            name: stamp_offset(recording, spec, name, recording.tables[topic]) or 0
            for name, topic in SOURCES.items()
            if name in recording.links and topic in recording.tables
        }
        super().__init__(spec, recording)

    def _offset(self, name: str) -> int:
        return self._offsets[name]


def samples_used(recording: Recording, spec: Spec) -> Used | str:
    """Samples that the controller used, or a sentence that says why they are not known."""
    if FORCE_REFERENCE not in recording.tables:
        return "numerical/force_reference is not recorded"
    try:
        schedule = _AsTold(spec, recording)
    except InputError:
        return "links/tau1 to links/tau4 are not all recorded"
    loop = spec.loop()
    sent, plant = recording.tables[COMMAND], recording.plant
    forces = recording.tables[FORCE_REFERENCE]
    commands = schedule.commands(0, schedule.end + 1)
    stamps = sent.stamp_ns - recording.start_ns
    row, recorded = rows_of(stamps, commands.time)
    motion = np.hstack([plant.columns(field, loop.interface.plant_dof) for field in ("position", "velocity")])
    state = _numbered(recording, plant, motion, commands.state, schedule.td1)
    reference = forces.columns("effort", loop.actuator.names)
    return Used(
        commands.time,
        np.where(recorded, row, -1),
        *state,
        *_numbered(recording, forces, reference, commands.reference, schedule.td2),
    )


def _numbered(
    recording: Recording, table: Table, values: Floats, numbers: Integers, period: int
) -> tuple[Integers, Floats]:
    """Stamps and values of samples with these numbers; NaN: not recorded, a stamp of -1: the initial one."""
    stamps = table.stamp_ns - recording.start_ns
    known = (stamps + period // 2) // period
    row, there = rows_of(known, numbers)
    found = np.where(there, stamps[row], numbers * period)
    return np.where(numbers == INITIAL, -1, found), np.where(there[:, None], values[row], np.nan)
