"""What a test of a component recorded: its motion, its force, and further inputs, on an even grid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.component.criteria import FEWEST_SAMPLES, LONGEST_GAP_STEPS
from rthm_analysis.component.motion import smooth_motion
from rthm_analysis.exchange.mapping import USUAL
from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.topics import INPUTS

if TYPE_CHECKING:
    from rthm_analysis.recording import Recording, Table
    from rthm_core.compiled import Flags, Floats


@dataclass(frozen=True)
class Channels:
    """Names of what a component test has: the motion that was imposed, the force that resisted, inputs."""

    motion: str
    force: str
    inputs: tuple[str, ...] = ()


@dataclass(frozen=True)
class ComponentTest:
    """One test of a component: motion in, force out.

    Attributes
    ----------
    name : str
        Of the recording.
    t : (s,) array
        Even instants, s.
    x, v : (s,) arrays
        Imposed motion without its noise, m and m/s.
    force : (s,) array
        Measured force, + where it resists a motion along +x, N.
    known : (s,) array
        Whether motion and force were recorded there.
    inputs : dict of (s,) arrays
        Further inputs, in units of their own.
    reversed : bool
        Whether the force was recorded with the other sign.
    """

    name: str
    t: Floats
    x: Floats
    v: Floats
    force: Floats
    known: Flags
    inputs: Mapping[str, Floats] = field(default_factory=dict)
    reversed: bool = False

    @property
    def step(self) -> float:
        """Between two samples, s."""
        return float(self.t[1] - self.t[0])


def channels_of(
    recording: Recording, motion: str = "", force: str = "", inputs: Sequence[str] = ()
) -> Channels:
    """Which signals are what: as named; else the force has the name that `rthm import` gives it, or that of
    the motion, and is the only one otherwise.

    Raises
    ------
    InputError
        A name is not there, or there are several that it can be.
    """
    table, beside = recording.plant, recording.tables.get(INPUTS)
    moving = _with(table, "position") or _with(table, "velocity")
    acting = [name for name in _with(table, "effort") if name not in inputs]
    motion = _one(motion, moving, "motion", "a position", "--motion")
    usual = next((name for name in (USUAL[False], motion) if name in acting), "")
    force = _one(force or usual, acting, "force", "a force", "--force")
    there = [*(name for name in _with(table, "effort") if name != force), *(beside.names if beside else ())]
    others = tuple(inputs) or tuple(name for name in there if name != motion)
    for name in others:
        if name not in there:
            raise InputError(
                f"--input {name} is no input of this recording, which has "
                f"{', '.join(there) or 'none'}; name one of these."
            )
    return Channels(motion, force, others)


def _with(table: Table, which: str) -> list[str]:
    """Names that have a field."""
    values = getattr(table, which)
    return [name for k, name in enumerate(table.names) if np.isfinite(values[:, k]).any()]


def _one(given: str, there: list[str], what: str, needed: str, option: str) -> str:
    if given in there:
        return given
    if given or len(there) != 1:
        known = ", ".join(there) or f"none, but a test of a component needs {needed}"
        asked = f"{option} is {given}" if given else f"the {what} of the component is not clear"
        raise InputError(f"{asked}: this recording has {known}; name one of these with {option}.")
    return there[0]


def component_test(recording: Recording, channels: Channels) -> ComponentTest:
    """Signals of a recording on an even grid, the force as that which resists the motion.

    Raises
    ------
    InputError
        There are too few samples in which motion and force are known.
    """
    table = recording.plant
    time = (table.stamp_ns - table.stamp_ns[0]) / NS
    if time.size < FEWEST_SAMPLES:
        raise InputError(
            f"{recording.path} has {time.size} samples, but a component needs at least {FEWEST_SAMPLES}; "
            "record more."
        )
    step = float(np.median(np.diff(time)))
    t = np.arange(0.0, time[-1] + 0.5 * step, step)
    column = {
        field: table.columns(field, [name])[:, 0]
        for field, name in (("position", channels.motion), ("velocity", channels.motion))
    }
    force = table.columns("effort", [channels.force])[:, 0]
    motion = column["position"] if np.isfinite(column["position"]).any() else column["velocity"]
    known = _near(time[np.isfinite(force) & np.isfinite(motion)], t, LONGEST_GAP_STEPS * step)
    if known.sum() < FEWEST_SAMPLES:
        raise InputError(
            f"{recording.path} has {known.sum()} samples with motion and force, but a component needs at "
            f"least {FEWEST_SAMPLES}; record more."
        )
    x, v = smooth_motion(t, _even(time, column["position"], t), _even(time, column["velocity"], t))
    inputs = {name: np.asarray(_even(*_input(recording, name), t)) for name in channels.inputs}
    resisting = _even(time, force, t)
    assert resisting is not None
    turned = float(np.sum((resisting * v)[known])) < 0.0
    return ComponentTest(recording.name, t, x, v, -resisting if turned else resisting, known, inputs, turned)


def _input(recording: Recording, name: str) -> tuple[Floats, Floats]:
    """Instants, s, and values of an input: of the topic of inputs, or a force of that name."""
    beside = recording.tables.get(INPUTS)
    table = beside if beside is not None and name in beside.names else recording.plant
    time = (table.stamp_ns - recording.plant.stamp_ns[0]) / NS
    return time, table.columns("effort", [name])[:, 0]


def _even(time: Floats, values: Floats, at: Floats) -> Floats | None:
    """Values between their samples on straight lines; None where there are none."""
    there = np.isfinite(values)
    return np.interp(at, time[there], values[there]) if there.any() else None


def _near(time: Floats, at: Floats, reach: float) -> Flags:
    """Whether there is a sample within reach."""
    if not time.size:
        return np.zeros(at.size, dtype=bool)
    after = np.clip(np.searchsorted(time, at), 1, max(time.size - 1, 1))
    return np.asarray(
        np.minimum(np.abs(at - time[after - 1]), np.abs(at - time[np.minimum(after, time.size - 1)])) <= reach
    )
