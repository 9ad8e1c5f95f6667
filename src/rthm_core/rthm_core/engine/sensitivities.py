"""`sensitivities`: how a trajectory changes with the parameters of its spec."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.clock import to_ns
from rthm_core.compiled import Floats
from rthm_core.engine.linear.blocks import Rows, joined
from rthm_core.engine.linear.kernel import ROW_COUNT
from rthm_core.engine.linear.preparation import filled
from rthm_core.engine.nonlinear.kernel import Looks
from rthm_core.engine.nonlinear.loop import NonlinearLoop, nonlinear_loop
from rthm_core.engine.nonlinear.run import Portion, State, looks_of, outputs, plan, start_state
from rthm_core.engine.simulate import checked_step, simulate
from rthm_core.engine.tangents.advance import TangentWork, Term
from rthm_core.engine.tangents.changes import Placement, Tangents, stencil, tangents
from rthm_core.engine.tangents.entries import PAIRS, TRIPLES, Look, look, look_entries, step_entries
from rthm_core.engine.tangents.kernel import Layout, TangentSteps, run_tangents
from rthm_core.engine.trajectory import Trajectory, of_rows
from rthm_core.errors import InputError
from rthm_core.kept import kept
from rthm_core.simd import WIDTH, simd_copy, simd_empty
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
    """A loop, what is seen of it, its derivatives and where they are, and memory for those of its steps."""

    loop: NonlinearLoop
    looks: Looks
    changes: Tangents
    placement: Placement
    steps: dict[int, TangentSteps]


@kept
def _prepared(spec: Spec, names: tuple[str, ...], step: int, energies: bool) -> _Prepared | None:
    """What the kernel needs for rows every `step` ns; None where it does not know the loop."""
    loop = nonlinear_loop(spec, energies=energies)
    if loop is None or not loop.nonlinear.steady or loop.linear.sensors is not None:
        return None
    found = tangents(spec, loop, names)
    return None if found is None else _Prepared(loop, looks_of(loop), *found, {})


def _steps(one: _Prepared, slots: int) -> TangentSteps:
    """Memory for the changes of so many steps."""
    if slots not in one.steps:
        loop, changes = one.loop, one.changes
        one.steps[slots] = TangentSteps(
            step_entries(loop, changes, slots),
            np.zeros(slots, dtype=np.int64),
            _row_look(loop, changes, slots),
            look(loop, changes, loop.sample, changes.sample, slots, PAIRS),
            look_entries(loop.reference, changes.reference),
        )
    return one.steps[slots]


def _row_look(loop: NonlinearLoop, changes: Tangents, slots: int) -> Look:
    """What is seen for a row [x1, v1, F, x2, v2] after so many steps."""
    d, plant = loop.sample.shape[1], loop.motion.size - loop.linear.numerical.y.size
    before, behind = np.split(np.eye(d)[loop.motion], [plant])
    moved = np.zeros((d, loop.motion.size + loop.force.shape[0], *changes.force.shape[2:]))
    moved[:, plant : plant + loop.force.shape[0]] = changes.force
    return look(loop, changes, np.vstack([before, loop.force, behind]), moved, slots, TRIPLES)


def _tangent_work(one: _Prepared, samples: int, references: int) -> TangentWork:
    """Tangents at the start of a test that looks back on so many samples and references."""
    changes = one.changes
    _, n, d, *groups = changes.systems.shape
    nothing = np.zeros((d, *groups))
    halves = simd_copy(np.zeros((2, *nothing.shape)))
    halves[:, : changes.start.shape[0]] = changes.start
    return TangentWork(
        halves,
        halves.reshape(-1),
        simd_copy(filled(changes.first_sample, samples)).reshape(-1),
        simd_copy(filled(changes.first_reference, references)).reshape(-1),
        simd_empty((one.loop.motion.size + one.loop.force.shape[0]) * WIDTH),
        np.zeros(n),
        simd_copy(nothing[0]),
        Term(np.zeros(n), simd_copy(nothing[:n])),
        Term(np.zeros(n), simd_copy(nothing[:n])),
        np.zeros(d),
        simd_copy(nothing),
        simd_empty(d, n, *groups),
    )


def _beside(
    spec: Spec, names: tuple[str, ...], end: int, step: int, *, energies: bool
) -> Sensitivities | None:
    """Sensitivities by tangents; None where there are none."""
    one = _prepared(spec, names, step, energies)
    found = None if one is None else plan(spec, one.loop, end, step, energies=energies, span=end + 1)
    if one is None or found is None:
        return None
    state, own = start_state(one.loop, 0, 0), _tangent_work(one, found.samples, found.references)
    blocks = [_block(one, portion, state, own, len(names)) for portion in found.portions]
    rows, (beside,) = (joined(parts) for parts in zip(*blocks, strict=True))
    ends = np.cumsum([part.shape[1] for part in rows[:2]])
    plant, numerical, reference = np.split(beside, ends, axis=1)
    every = of_rows(spec, Rows(plant, numerical, reference, np.empty((0, 0))), step)
    places = {names[p]: place for place, p in enumerate(one.placement.order)}
    by_parameter = {name: _of_one(every, places[name]) for name in names}
    return Sensitivities(of_rows(spec, Rows(*rows), step), by_parameter, tangents=True)


def _of_one(every: Trajectory, parameter: int) -> Trajectory:
    """Tangents for one parameter; those for all have the parameters along their last axis."""
    return Trajectory(every.t, **{name: getattr(every, name)[..., parameter] for name in SIGNALS})


def _block(
    one: _Prepared, portion: Portion, state: State, own: TangentWork, parameters: int
) -> tuple[list[Floats], list[Floats]]:
    """Rows of a portion and their tangents, without the last, which is beyond it: a full block would end the
    run.
    """
    loop, out = one.loop, outputs(one.loop, portion.rows + 1)
    shape = (portion.rows + 1, sum(array.shape[1] for array in out[:3]), parameters)
    beside, groups = np.empty(math.prod(shape)), one.changes.start.shape[1]
    like = tuple((0,) * (rows * groups) for rows in (1, PAIRS, TRIPLES))
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
        out,
        one.changes,
        _steps(one, portion.steps.filled.size),
        own,
        Layout(parameters, one.placement.before, one.placement.counts, one.placement.motion),
        like,
        beside,
    )
    return [rows[:-1] for rows in out], [beside.reshape(shape)[:-1]]


def _difference(spec: Spec, name: str, duration: float, sample: float) -> Trajectory:
    """Derivative of a trajectory by simulating neighbours of its spec."""
    weighted = [
        (weight, simulate(beside, duration, sample, energies=False)) for beside, weight in stencil(spec, name)
    ]
    arrays = {
        name: sum(weight * getattr(trajectory, name) for weight, trajectory in weighted) for name in SIGNALS
    }
    return Trajectory(weighted[0][1].t, **arrays)
