"""`sensitivities`: how a trajectory changes with the parameters of its spec."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.clock import to_ns
from rthm_core.compiled import Floats, Integers
from rthm_core.engine.linear.blocks import Rows, joined
from rthm_core.engine.linear.kernel import ROW_COUNT
from rthm_core.engine.linear.preparation import filled
from rthm_core.engine.nonlinear.kernel import Looks
from rthm_core.engine.nonlinear.loop import NonlinearLoop, nonlinear_loop
from rthm_core.engine.nonlinear.run import Portion, State, looks_of, plan, start_state
from rthm_core.engine.simulate import checked_step, simulate
from rthm_core.engine.tangents.advance import Scratch, TangentWork, scratch
from rthm_core.engine.tangents.changes import Placement, Tangents, stencil, tangents
from rthm_core.engine.tangents.entries import PAIRS, TRIPLES, by_blocks, look, look_entries, step_entries
from rthm_core.engine.tangents.kernel import Layout, TangentSteps, run_tangents
from rthm_core.engine.trajectory import Trajectory, of_rows
from rthm_core.errors import InputError
from rthm_core.kept import kept
from rthm_core.simd import WIDTH, simd_copy
from rthm_core.spec import parameters

if TYPE_CHECKING:
    from rthm_core.spec import EffectSpec, Spec

PHYSICAL = ("plant", "numerical", "interface", "actuator.stiffness", "actuator.motor_poles", "load")
"""Sections whose numbers are parameters of the physics, beside those of the effects."""

INITIAL = ("initial_position", "initial_velocity")
"""Numbers of a substructure that are no property of it."""

SIGNALS = tuple(one.name for one in fields(Trajectory) if one.name not in ("t", "energies"))
"""Arrays of a trajectory that have derivatives."""

NOT_SMOOTH = ("timing", "noise", "uncertainty", "limits", "actuator.compensator_order")
"""Sections on which no trajectory depends smoothly: clocks count in ns; what is random or rounded jumps."""


@dataclass
class Sensitivities:
    """A trajectory and its derivatives.

    Attributes
    ----------
    trajectory : Trajectory
    by_parameter : dict of Trajectory
        Derivative of each of its arrays with respect to one parameter, in SI units over the parameter's;
        `t` is the time of the rows.
    tangents : bool
        Whether they were computed beside the trajectory, or by differences of whole simulations, which is
        what remains where laws are neither linear nor dry friction, or samples are noisy.
    """

    trajectory: Trajectory
    by_parameter: dict[str, Trajectory]
    tangents: bool


def sensitivities(
    spec: Spec,
    duration: float,
    names: Sequence[str] | None = None,
    sample: float | None = None,
    *,
    energies: bool = True,
) -> Sensitivities:
    """Simulate a loop exactly, and how it changes with parameters.

    Parameters
    ----------
    spec : Spec
        A loop.
    duration : float
        Length in s.
    names : sequence of str, optional
        Dotted names of numbers, as in `apply`; every one of the physics when absent.
    sample : float, optional
        Distance of the rows in s; Td1 when absent.
    energies : bool
        Whether the work of the trajectory is counted; it has no derivatives.

    Raises
    ------
    InputError
        When the spec is no loop, duration or sample is not a positive number, or a name is not that of a
        number on which the motion depends smoothly.
    """
    step = checked_step(spec, duration, sample)
    spec.loop()
    chosen = physical_numbers(spec) if names is None else _checked(spec, tuple(names))
    beside = _beside(spec, chosen, to_ns(duration), step, energies=energies)
    if beside is not None:
        return beside
    trajectory = simulate(spec, duration, step * 1e-9, energies=energies)
    by_parameter = {name: _difference(spec, name, duration, step * 1e-9) for name in chosen}
    return Sensitivities(trajectory, by_parameter, tangents=False)


@kept
def physical_numbers(spec: Spec) -> tuple[str, ...]:
    """Names of all numbers of the physics that are not zero: properties of both sides and of what joins
    them, of loads and of effects.
    """
    sections = (*PHYSICAL, *(one.name for one in spec.effects if not _shifts_time(one)))
    found: list[str] = []
    for one in parameters(spec):
        initial = one.name.endswith(INITIAL)
        if initial or not _within(one.name, sections) or not one.type.startswith("double"):
            continue
        values = one.value if isinstance(one.value, list) else [one.value]
        single = len(values) == 1
        found += [one.name if single else f"{one.name}[{i}]" for i, value in enumerate(values) if value]
    return tuple(found)


def _within(name: str, sections: Sequence[str]) -> bool:
    """Whether a dotted name is one of some entries or stands in one of some sections."""
    return any(f"{name.partition('[')[0]}.".startswith(f"{section}.") for section in sections)


def _shifts_time(one: EffectSpec) -> bool:
    """Whether an effect decides when something happens, which is an instant in ns."""
    return one.block.startswith("link") or one.law.changes == "delay"


@kept
def _checked(spec: Spec, names: tuple[str, ...]) -> tuple[str, ...]:
    """The names; refuses those on which no motion depends smoothly."""
    refused = (*NOT_SMOOTH, *(one.name for one in spec.effects if _shifts_time(one)))
    for name in names:
        if _within(name, refused):
            raise InputError(
                f"{name} is nothing on which a motion depends smoothly, allowed are numbers of the plant, "
                f"the numerical side, the interface, the actuators, loads and effects; leave it out."
            )
    return names


class _Prepared(NamedTuple):
    """A loop, its start and what is seen of it, its derivatives and where they are; memory for those of its
    steps, and scratch.
    """

    loop: NonlinearLoop
    start: State
    looks: Looks
    changes: Tangents
    placement: Placement
    steps: dict[int, _Memory]
    scratch: Scratch


class _Memory(NamedTuple):
    """Memory for the changes of steps; where the signals of a row are written, None: in their order."""

    steps: TangentSteps
    places: Integers | None


@kept
def _prepared(spec: Spec, names: tuple[str, ...], step: int, energies: bool) -> _Prepared | None:
    """What the kernel needs for rows every `step` ns; None where it does not know the loop."""
    loop = nonlinear_loop(spec, energies=energies)
    if loop is None or not loop.nonlinear.steady or loop.linear.sensors is not None:
        return None
    found = tangents(spec, loop, names)
    if found is None:
        return None
    start, memory = start_state(loop, 0, 0), scratch(found[0].systems.shape)
    return _Prepared(loop, start, looks_of(loop), *found, {}, memory)


def _steps(one: _Prepared, slots: int) -> _Memory:
    """Memory for the changes of so many steps."""
    if slots not in one.steps:
        loop, changes = one.loop, one.changes
        rows, moved = _of_rows(loop, changes)
        order = by_blocks(loop, changes, rows, moved)
        steps = TangentSteps(
            step_entries(loop, changes, slots),
            np.zeros(slots, dtype=np.int64),
            look(loop, changes, rows[order], moved[:, order], slots, TRIPLES),
            look(loop, changes, loop.sample, changes.sample, slots, PAIRS),
            look_entries(loop.reference, changes.reference),
        )
        beyond = np.arange(rows.shape[0], rows.shape[0] + loop.linear.k_tot.size)
        places = np.concatenate([np.argsort(order), beyond])
        one.steps[slots] = _Memory(steps, None if np.all(np.diff(places) == 1) else places)
    return one.steps[slots]


def _of_rows(loop: NonlinearLoop, changes: Tangents) -> tuple[Floats, Floats]:
    """What is seen for a row [x1, v1, F, x2, v2], and its transposed changes."""
    d, plant = loop.sample.shape[1], loop.motion.size - loop.linear.numerical.y.size
    before, behind = np.split(np.eye(d)[loop.motion], [plant])
    moved = np.zeros((d, loop.motion.size + loop.force.shape[0], *changes.force.shape[2:]))
    moved[:, plant : plant + loop.force.shape[0]] = changes.force
    return np.vstack([before, loop.force, behind]), moved


def _begun(start: State) -> State:
    """A start that a run may change; scratch is that of every run."""
    work = start.work._replace(modes=start.work.modes.copy(), sums=simd_copy(start.work.sums))
    memory = start.memory._replace(count=start.memory.count.copy())
    return State(start.z.copy(), work, memory)


def _tangent_work(one: _Prepared, samples: int, references: int) -> TangentWork:
    """Tangents at the start of a test that looks back on so many samples and references."""
    changes, (_, _, d, *groups) = one.changes, one.changes.systems.shape
    halves = simd_copy(np.zeros((2, d, *groups)))
    halves[:, : changes.start.shape[0]] = changes.start
    return TangentWork(
        halves,
        halves.reshape(-1),
        simd_copy(filled(changes.first_sample, samples)).reshape(-1),
        simd_copy(filled(changes.first_reference, references)).reshape(-1),
        *one.scratch,
    )


def _beside(
    spec: Spec, names: tuple[str, ...], end: int, step: int, *, energies: bool
) -> Sensitivities | None:
    """Sensitivities by tangents; None where there are none."""
    one = _prepared(spec, names, step, energies)
    found = None if one is None else plan(spec, one.loop, end, step, energies=energies, span=end + 1)
    if one is None or found is None:
        return None
    state, own = _begun(one.start), _tangent_work(one, found.samples, found.references)
    beside, work = joined([_block(one, portion, state, own, len(names)) for portion in found.portions])
    m, n = one.loop.linear.k_tot.size, one.loop.linear.numerical.y.size
    plant = beside.shape[1] - n - m
    parts = beside[:, :plant], beside[:, plant : plant + n], beside[:, plant + n :]
    every = of_rows(spec, Rows(*parts, work), step)
    by_parameter = {
        name: _of_one(every, place) for name, place in zip(names, one.placement.places.tolist(), strict=True)
    }
    motion = _of_one(every, -1)
    motion.energies = every.energies
    return Sensitivities(motion, by_parameter, tangents=True)


def _of_one(every: Trajectory, place: int) -> Trajectory:
    """Tangents for one parameter, or last the motion; all have the parameters along their last axis."""
    return Trajectory(every.t, **{name: getattr(every, name)[..., place] for name in SIGNALS})


def _block(
    one: _Prepared, portion: Portion, state: State, own: TangentWork, parameters: int
) -> tuple[Floats, Floats]:
    """Rows of a portion (rows, signals, parameters), the last of which are the signals themselves, and work;
    without the last row, which is beyond it: a full block would end the run.
    """
    loop, memory, rows = one.loop, _steps(one, portion.steps.filled.size), portion.rows + 1
    work = np.empty((rows if loop.forms.size else 0, loop.forms.shape[0]))
    shape = (rows, memory.steps.row.rows.shape[0] + loop.linear.k_tot.size, parameters + 1)
    size, groups = math.prod(shape), one.changes.start.shape[1]
    beside = np.empty(size + WIDTH)
    like = tuple((0,) * (abreast * groups) for abreast in (1, PAIRS, TRIPLES))
    state.memory.count[ROW_COUNT] = 0
    run_tangents(
        loop.nonlinear,
        portion.steps,
        state.work,
        one.looks,
        portion.operations,
        state.memory.count,
        state.z,
        portion.passes,
        rows,
        work,
        one.changes,
        memory.steps,
        own,
        Layout(parameters + 1, one.placement.before, one.placement.motion),
        like,
        beside,
    )
    written = beside[:size].reshape(shape)[:-1]
    return written if memory.places is None else written[:, memory.places], work[:-1]


def _difference(spec: Spec, name: str, duration: float, sample: float) -> Trajectory:
    """Derivative of a trajectory by simulating neighbours of its spec."""
    weighted = [
        (weight, simulate(beside, duration, sample, energies=False)) for beside, weight in stencil(spec, name)
    ]
    arrays = {
        name: sum(weight * getattr(trajectory, name) for weight, trajectory in weighted) for name in SIGNALS
    }
    return Trajectory(weighted[0][1].t, **arrays)
