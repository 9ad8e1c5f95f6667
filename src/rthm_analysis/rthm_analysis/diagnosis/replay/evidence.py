"""What a recording holds of the physical side: what went in, what was measured, and when."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.replay import (
    CHANNEL_FEWEST_SHARE,
    REST_MOST_SHARE,
    STRAY_COMMANDS_SHARE,
)
from rthm_analysis.diagnosis.criteria.samples import REST_KEPT_RATIO, REST_LEAST_KEPT_SAMPLES
from rthm_analysis.diagnosis.criteria.verdict import TRAINED_SHARE
from rthm_analysis.diagnosis.links.stamps import sent_stamps
from rthm_analysis.diagnosis.replay.resting import rest_begin, rests
from rthm_analysis.recording import Recording, hold
from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.link import Link
from rthm_core.schedule import overtaking
from rthm_core.topics import ACCELERATION, COMMAND, INPUTS

if TYPE_CHECKING:
    from collections.abc import Container

    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec import Spec

MOTION = ("position", "velocity", "acceleration")
"""Families of measured signals of a dof, each the rate of the one before."""

CHANNELS = (*MOTION, "force", "motor")
"""Families of measured signals of the physical side."""


UNIT_OF = {"position": "m", "velocity": "m/s", "acceleration": "m/s^2", "force": "N", "motor": "m"}


RATES = {"velocity": "v", "acceleration": "acc"}
"""What the names of their signals begin with; a1 would be an actuator."""


@dataclass(frozen=True)
class Channel:
    """One measured signal: its family and its place (dof or actuator)."""

    family: str
    place: str

    @property
    def signal(self) -> str:
        """Name for the eye: x1, v1, acc1, F and u where there is one of each."""
        number = (
            self.place[1:] if self.place[:1] in ("x", "a") and self.place[1:].isdigit() else f"_{self.place}"
        )
        if self.family == "position":
            return self.place
        if self.family in RATES:
            return f"{RATES[self.family]}{number}"
        return ("F" if self.family == "force" else "u") + (number if number != "1" else "")


@dataclass(frozen=True, eq=False)
class Evidence:
    """Inputs and outputs of the physical side in a recording, or in several one after the other; equal to
    nothing but itself.

    Attributes
    ----------
    stamps_ns : (s,) array
        Of the samples, ns since the start of the test.
    due_ns, commands : (c,), (c, m) arrays
        Commands and the instants at which they reached the motors; empty without actuators.
    load : (s, n) array
        Known external loads on the dofs, N.
    channels : tuple of k Channel
        What was measured.
    measured : (s, k) array
        NaN where it is not known.
    driven_by : str
        ``"command"``, or ``"force"`` when the known forces are all that drives the plant.
    notes : tuple of str
        What could not be used.
    under_way : float
        Shortest time from the stamp of a command to its arrival, s; no motor can answer earlier by more.
    begins : tuple of int
        First sample of each recording, and of each part of one that begins anew behind what was left out.
    names : tuple of str
        Of the recordings; that of a single one is empty.
    ends_at_rest : bool
        Whether most of a rest behind it was left out (`until_rest`).
    own_zero : tuple of Channel
        Those whose zero is each recording's own, so that a constant in one says nothing.
    """

    stamps_ns: Integers
    due_ns: Integers
    commands: Floats
    load: Floats
    channels: tuple[Channel, ...]
    measured: Floats
    driven_by: str
    notes: tuple[str, ...] = ()
    under_way: float = 0.0
    begins: tuple[int, ...] = (0,)
    names: tuple[str, ...] = ("",)
    ends_at_rest: bool = False
    own_zero: tuple[Channel, ...] = ()

    @cached_property
    def time(self) -> Floats:
        """Of the samples, s."""
        return self.stamps_ns / NS

    @cached_property
    def is_forced(self) -> bool:
        """Whether anything known drives the plant: nobody can tell all its matrices from their multiples in a
        motion that dies away by itself.
        """
        return self.driven_by == "command" or bool(np.any(self.load))

    @property
    def recordings(self) -> list[slice]:
        """Samples of each recording."""
        return [slice(*ends) for ends in pairwise((*self.begins, self.stamps_ns.size))]

    @property
    def spans(self) -> list[tuple[float, float]]:
        """Begin and end of each recording, s; the first begins with the test."""
        begins = [0.0, *(float(self.time[first]) for first in self.begins[1:])]
        return [(a, float(self.time[one][-1])) for a, one in zip(begins, self.recordings, strict=True)]

    @property
    def longest(self) -> float:
        """Duration of the longest recording, s."""
        return max(end - begin for begin, end in self.spans)

    @property
    def trained(self) -> int:
        """Samples, from the first, that fits and choices may see: of several recordings all but the last."""
        return self.begins[-1] if self.has_several else int(TRAINED_SHARE * self.stamps_ns.size)

    @property
    def has_several(self) -> bool:
        """Whether it is of several recordings, and not of the parts of one."""
        return len(self.names) > 1

    @cached_property
    def comes_to_rest(self) -> bool:
        """Whether nothing moves in the unseen part any more: it then confirms where it rests, and no law
        of its motion.
        """
        motion = [i for i, one in enumerate(self.channels) if one.family in ("position", "velocity")]
        return all(rests(self.measured[:, i], self.trained) for i in motion)

    def until_rest(self) -> Evidence:
        """The same without most of the rest that it ends in, where nothing moves in the unseen part: the end
        of the motion then confirms. All of it where there are several recordings, or too little moves.
        """
        if self.has_several or not self.comes_to_rest:
            return self
        motion = [i for i, one in enumerate(self.channels) if one.family in ("position", "velocity")]
        begin = max(rest_begin(self.measured[:, i], self.trained) for i in motion)
        kept = int(REST_KEPT_RATIO * begin)
        if kept < REST_LEAST_KEPT_SAMPLES:
            return self
        note = f"Nothing moves after {self.time[begin]:.3g} s: of the rest, little is used."
        return replace(self.first(kept), notes=(*self.notes, note), ends_at_rest=True)

    def rates(self, values: Floats) -> Floats:
        """Rates (s,) of some values (s,) in each recording by itself."""
        return np.concatenate([np.gradient(values[one], self.time[one]) for one in self.recordings])

    @cached_property
    def period(self) -> float:
        """Mean period of the recorded motion, s."""
        position = np.nan_to_num(self.measured[:, 0])
        rate = self.rates(position)
        return 2.0 * np.pi * float(position.std()) / max(float(rate.std()), 1e-300)

    def kept(self, samples: Integers | slice) -> Evidence:
        """What some of its samples say, in their order."""
        rows = np.arange(self.stamps_ns.size)[samples]
        return replace(
            self,
            stamps_ns=self.stamps_ns[samples],
            load=self.load[samples],
            measured=self.measured[samples],
            begins=tuple(
                int(one) for one in np.unique(np.searchsorted(rows, self.begins)) if one < rows.size
            ),
        )

    def without_part(self, samples: slice) -> Evidence:
        """The same without some samples, behind which the motion begins anew."""
        anew = replace(self, begins=tuple(sorted({*self.begins, samples.stop})))
        return anew.kept(np.delete(np.arange(self.stamps_ns.size), samples))

    def first(self, samples: int) -> Evidence:
        """The first part of it."""
        return self.kept(slice(samples))

    def only(self, *families: str) -> Evidence:
        """What channels of some families say."""
        return self.without([i for i, one in enumerate(self.channels) if one.family not in families])

    def under_command(self) -> Evidence:
        """The same without what wires and motors did before the first command arrived: where they stood until
        then, the spec knows no better than its initial position. All of it where that lasted long.
        """
        rest = int(np.searchsorted(self.stamps_ns, self.due_ns[0])) if self.due_ns.size else 0
        if not rest or rest > REST_MOST_SHARE * self.stamps_ns.size:
            return self
        moved = [k for k, one in enumerate(self.channels) if one.family in ("force", "motor")]
        measured = self.measured.copy()
        measured[:rest, moved] = np.nan
        return replace(self, measured=measured)

    def without(self, columns: Container[int]) -> Evidence:
        """What the other channels say."""
        kept = [i for i in range(len(self.channels)) if i not in columns]
        channels = tuple(self.channels[i] for i in kept)
        return replace(self, channels=channels, measured=self.measured[:, kept])


def gather(recording: Recording, spec: Spec) -> Evidence:
    """Collect what drives the physical side and what was measured of it.

    Raises
    ------
    InputError
        Nothing was measured of a plant under known forces, or its acceleration alone.
    """
    assert spec.plant is not None
    plant = recording.plant
    stamps = plant.stamp_ns - recording.start_ns
    dofs = spec.plant.dofs
    notes: list[str] = []
    load = np.nan_to_num(plant.columns("effort", dofs))
    names = spec.actuator.names if spec.actuator else ()
    due, commands, under_way = _commands(recording, spec, names)
    if names and not due.size:
        notes.append(
            "No commands are recorded: motor and wire cannot be checked; the measured force drives the plant."
        )
        names = ()
        others = [name for name in plant.names if name not in dofs]
        load = _with_forces(plant, others, load, spec)
    elif not names:
        load = _with_forces(plant, [name for name in plant.names if name not in dofs], load, spec)
    if INPUTS in recording.tables:
        inputs = ", ".join(recording.tables[INPUTS].names)
        notes.append(
            f"{inputs} is an input of a component, on which no law here depends: `rthm component` finds "
            "what it does."
        )
    channels, columns = [], []
    for family, places, values in (
        ("position", dofs, plant.columns("position", dofs)),
        ("velocity", dofs, plant.columns("velocity", dofs)),
        ("acceleration", *_accelerations(recording, dofs, notes)),
        ("force", names, plant.columns("effort", names)),
        ("motor", names, plant.columns("position", names)),
    ):
        for place, column in zip(places, values.T, strict=True):
            if np.isfinite(column).mean() > CHANNEL_FEWEST_SHARE:
                channels.append(Channel(family, place))
                columns.append(column)
            else:
                notes.append(f"The {family} of {place} is not recorded.")
    _check_motion(recording, channels, "command" if due.size else "force")
    return Evidence(
        stamps,
        due,
        commands,
        load,
        tuple(channels),
        np.stack(columns, axis=1),
        "command" if due.size else "force",
        tuple(notes),
        under_way,
    )


def _check_motion(recording: Recording, channels: list[Channel], driven_by: str) -> None:
    """Raise InputError where nothing says around which position, and from where, a plant moves."""
    families = {one.family for one in channels}
    if families & {"position", "velocity"} or (families and driven_by == "command"):
        return
    has = "the acceleration of its plant alone" if families else "nothing of the motion of its plant"
    raise InputError(
        f"{recording.path} has {has}: where a motion begins, and around which position, does not show in an "
        "acceleration, which has an offset of its own; record a position or a velocity beside it."
    )


def _accelerations(
    recording: Recording, dofs: tuple[str, ...], notes: list[str]
) -> tuple[tuple[str, ...], Floats]:
    """Dofs of which an acceleration is recorded, and these at the samples of the plant (s, k), m/s^2."""
    table = recording.tables.get(ACCELERATION)
    seen = tuple(dof for dof in dofs if table is not None and dof in table.names)
    values = recording.accelerations(seen)
    if not seen or np.isfinite(values).any():
        return seen, values
    notes.append(
        f"No sample of {ACCELERATION} has the stamp of one of plant/state, so that accelerations are not "
        "used: resample both to the same instants."
    )
    return (), values[:, :0]


def _with_forces(plant, others: list[str], load: Floats, spec: Spec) -> Floats:  # type: ignore[no-untyped-def]
    """Add the forces of the names beyond the dofs: on the dof of their actuator, or on the only one."""
    total = load.copy()
    places: dict[str, str] = {}
    if spec.actuator and spec.interface:
        places = dict(zip(spec.actuator.names, spec.interface.plant_dof, strict=False))
    for name, column in zip(others, np.nan_to_num(plant.columns("effort", others)).T, strict=True):
        dof = spec.plant.dofs.index(places[name]) if name in places else 0
        total[:, dof] += column
    return total


def _commands(recording: Recording, spec: Spec, names: tuple[str, ...]) -> tuple[Integers, Floats, float]:
    """Instants at which commands reached the motors, the commands, and how long they were under way at least.

    Where no uses are recorded, the link is taken to do what the spec says.
    """
    sent = recording.tables.get(COMMAND)
    if sent is None or not names:
        return np.empty(0, dtype=np.int64), np.empty((0, len(names))), 0.0
    uses = recording.links.get("tau4")
    values = sent.columns("position", names)
    if uses is None:
        stamps, link = sent.stamp_ns - recording.start_ns, Link(spec, "tau4")
        due = link.due_all(stamps)
        used = overtaking(due)
        return due[used], values[used], link.delay_ns / NS
    order = np.argsort(uses.use_ns, kind="stable")
    at, stamps = uses.use_ns[order], sent_stamps(recording, spec, "tau4", sent)[order]
    under_way = float(np.quantile(at - stamps, STRAY_COMMANDS_SHARE)) / NS if at.size else 0.0
    return at - recording.start_ns, hold(sent.stamp_ns, values, stamps), max(under_way, 0.0)
