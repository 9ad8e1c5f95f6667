"""Run a loop and its tangents: which kernel does it, and with which memory."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers
from rthm_core.engine.linear.blocks import joined
from rthm_core.engine.linear.kernel import ROW_COUNT
from rthm_core.engine.linear.preparation import filled
from rthm_core.engine.nonlinear.kernel import Looks
from rthm_core.engine.nonlinear.loop import NonlinearLoop, nonlinear_loop
from rthm_core.engine.nonlinear.run import Portion, State, looks_of, plan, start_state
from rthm_core.engine.tangents.advance import Scratch, TangentWork, scratch
from rthm_core.engine.tangents.changes import Placement, Tangents, tangents
from rthm_core.engine.tangents.entries import PAIRS, TRIPLES, by_blocks, look, look_entries, step_entries
from rthm_core.engine.tangents.followed import run_followed
from rthm_core.engine.tangents.following import FollowedSteps, FollowedWork, followed_steps, followed_work
from rthm_core.engine.tangents.kernel import Layout, TangentSteps, run_tangents
from rthm_core.engine.tangents.slopes import Slopes, slopes
from rthm_core.kept import kept
from rthm_core.simd import WIDTH, simd_copy

if TYPE_CHECKING:
    from rthm_core.spec import Spec


class Prepared(NamedTuple):
    """A loop, its start and what is seen of it, its derivatives and where they are; memory for those of its
    steps; scratch, or where forces change within a step what they are asked about.
    """

    loop: NonlinearLoop
    start: State
    looks: Looks
    changes: Tangents
    placement: Placement
    steps: dict[int, _Memory]
    scratch: Scratch
    ask: Slopes | None


class _Memory(NamedTuple):
    """Memory for the changes of steps; where the signals of a row are written, None: in their order."""

    steps: TangentSteps | FollowedSteps
    places: Integers | None


@kept
def prepared(spec: Spec, names: tuple[str, ...], step: int, energies: bool) -> Prepared | None:
    """What the kernel needs for rows every `step` ns; None where it does not know the loop."""
    loop = nonlinear_loop(spec, energies=energies)
    if loop is None or loop.linear.sensors is not None:
        return None
    found = tangents(spec, loop, names)
    ask = None if found is None or loop.nonlinear.steady else slopes(loop.nonlinear, found[0])
    if found is None or (ask is None and not loop.nonlinear.steady):
        return None
    start, memory = start_state(loop, 0, 0), scratch(found[0].systems.shape)
    return Prepared(loop, start, looks_of(loop), *found, {}, memory, ask)


def run(spec: Spec, one: Prepared, end: int, step: int, *, energies: bool) -> tuple[Floats, Floats] | None:
    """Rows (rows, signals, parameters), the last of which are the signals themselves, and work; None where
    there is no fast way for it.
    """
    found = plan(spec, one.loop, end, step, energies=energies, span=end + 1)
    if found is None:
        return None
    state, own = _begun(one.start), _work(one, found.samples, found.references)
    rows, work = joined([_block(one, portion, state, own) for portion in found.portions])
    return rows, work


def _steps(one: Prepared, slots: int) -> _Memory:
    """Memory for the changes of so many steps."""
    if slots not in one.steps:
        rows, moved = _of_rows(one.loop, one.changes)
        make: Any = _tangent_steps if one.ask is None else followed_steps
        steps, order = make(one.loop, one.changes, rows, moved, slots)
        beyond = np.arange(rows.shape[0], rows.shape[0] + one.loop.linear.k_tot.size)
        places = np.concatenate([np.argsort(order), beyond])
        one.steps[slots] = _Memory(steps, None if np.all(np.diff(places) == 1) else places)
    return one.steps[slots]


def _tangent_steps(
    loop: NonlinearLoop, changes: Tangents, rows: Floats, moved: Floats, slots: int
) -> tuple[TangentSteps, Integers]:
    """Memory for so many steps with constant forces, and the order in which `rows` are written."""
    order = by_blocks(loop, changes, rows, moved)
    steps = TangentSteps(
        step_entries(loop, changes, slots),
        np.zeros(slots, dtype=np.int64),
        look(loop, changes, rows[order], moved[:, order], slots, TRIPLES),
        look(loop, changes, loop.sample, changes.sample, slots, PAIRS),
        look_entries(loop.reference, changes.reference),
    )
    return steps, order


def _of_rows(loop: NonlinearLoop, changes: Tangents) -> tuple[Floats, Floats]:
    """What is seen for a row [x1, v1, F, x2, v2], and its transposed changes."""
    d, plant = loop.sample.shape[1], loop.motion.size - loop.linear.numerical.y.size
    before, behind = np.split(np.eye(d)[loop.motion], [plant])
    moved = np.zeros((d, loop.motion.size + loop.force.shape[0], *changes.force.shape[2:]))
    moved[:, plant : plant + loop.force.shape[0]] = changes.force
    return np.vstack([before, loop.force, behind]), moved


def _begun(start: State) -> State:
    """A start that a run may change; scratch is that of every run."""
    last = start.work
    work = last._replace(
        sums=simd_copy(last.sums),
        modes=last.modes.copy(),
        trend=last.trend.copy(),
        pace=last.pace.copy(),
        contraction=last.contraction.copy(),
        scale=last.scale.copy(),
    )
    memory = start.memory._replace(count=start.memory.count.copy())
    return State(start.z.copy(), work, memory)


def _work(one: Prepared, samples: int, references: int) -> TangentWork | FollowedWork:
    """Tangents at the start of a test that looks back on so many samples and references."""
    changes, (_, _, d, *groups) = one.changes, one.changes.systems.shape
    past = filled(changes.first_sample, samples), filled(changes.first_reference, references)
    if one.ask is not None:
        return followed_work(one.loop, changes, one.ask, *past)
    halves = simd_copy(np.zeros((2, d, *groups)))
    halves[:, : changes.start.shape[0]] = changes.start
    before, asked = (simd_copy(part).reshape(-1) for part in past)
    return TangentWork(halves, halves.reshape(-1), before, asked, *one.scratch)


def _block(
    one: Prepared, portion: Portion, state: State, own: TangentWork | FollowedWork
) -> tuple[Floats, Floats]:
    """Rows of a portion, and work; without the last row, which is beyond it: a full block would end the
    run.
    """
    loop, memory, rows = one.loop, _steps(one, portion.steps.filled.size), portion.rows + 1
    work = np.empty((rows if loop.forms.size else 0, loop.forms.shape[0]))
    columns = one.placement.places.size + 1
    shape = (rows, memory.steps.row.rows.shape[0] + loop.linear.k_tot.size, columns)
    size, groups = math.prod(shape), one.changes.start.shape[1]
    beside = np.empty(size + WIDTH)
    state.memory.count[ROW_COUNT] = 0
    kernel: Any = run_tangents if one.ask is None else run_followed
    packed = () if one.ask is None else (portion.packed,)
    kernel(
        loop.nonlinear,
        portion.steps,
        *packed,
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
        Layout(columns, one.placement.before, one.placement.motion),
        tuple((0,) * (abreast * groups) for abreast in (1, PAIRS, TRIPLES)),
        beside,
    )
    written = beside[:size].reshape(shape)[:-1]
    return written if memory.places is None else written[:, memory.places], work[:-1]
