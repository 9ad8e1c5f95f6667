"""Simulate a loop whose plant has laws that are not linear: reduce it to a program and run the kernel."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers
from rthm_core.engine.digits import LONGEST_LENGTH, digit_lengths, in_digits
from rthm_core.engine.linear.blocks import CHUNK_NS, Rows, rows_within
from rthm_core.engine.linear.kernel import ROW_COUNT, Memory
from rthm_core.engine.linear.preparation import filled
from rthm_core.engine.nonlinear.advance import Work, work
from rthm_core.engine.nonlinear.kernel import Looks, Outputs, run_nonlinear
from rthm_core.engine.nonlinear.loop import NonlinearLoop, nonlinear_loop
from rthm_core.engine.nonlinear.operations import (
    Operations,
    longest_step,
    numbered,
    split,
    step_by_step,
)
from rthm_core.engine.nonlinear.packed import HALVINGS, Packed, packed
from rthm_core.engine.nonlinear.steps import ORDERS, Steps
from rthm_core.engine.nonlinear.tables import tables_over, tables_over_digits
from rthm_core.engine.program import (
    Program,
    period_ns,
    program,
    reach_ns,
    without_unused_samples,
)
from rthm_core.kept import kept
from rthm_core.physical.sensors import Sensors
from rthm_core.schedule import OUTPUT, Schedule
from rthm_core.simd import WIDTH, simd_copy

if TYPE_CHECKING:
    from rthm_core.spec import Spec

LARGEST_TABLE = 8_000_000
"""Most numbers in the matrices of the steps."""


class _Prepared(NamedTuple):
    """A program with its memory of steps."""

    operations: Operations
    steps: Steps
    packed: Packed


class State(NamedTuple):
    """What lasts from block to block."""

    z: Floats
    work: Work
    memory: Memory


@kept
def _loop(spec: Spec, energies: bool) -> NonlinearLoop | None:
    return nonlinear_loop(spec, energies=energies)


@kept
def _looks(spec: Spec, energies: bool) -> Looks:
    """What is seen of a loop."""
    loop = _loop(spec, energies)
    assert loop is not None
    return looks_of(loop)


def looks_of(loop: NonlinearLoop) -> Looks:
    """What is seen of a loop."""
    upper = np.triu_indices(loop.nonlinear.systems.shape[2])
    double = np.where(upper[0] == upper[1], 1.0, 2.0)
    forms = np.empty((0, 0)) if not loop.forms.size else loop.forms[:, upper[0], upper[1]] * double
    none = Sensors(np.zeros((0, 5)), np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.uint64))
    linear = loop.linear
    return Looks(
        loop.motion,
        linear.bias,
        linear.sensors or none,
        linear.k_tot,
        np.ascontiguousarray(forms),
    )


def _columns(loop: NonlinearLoop) -> Floats:
    """What is seen of [y, held, g], in SIMD values."""
    size, plant = loop.sample.shape[1], loop.motion.size - loop.linear.numerical.y.size
    motion = np.eye(size)[loop.motion]
    looks = np.vstack([motion[:plant], loop.force, motion[plant:], loop.sample, loop.reference])
    wide = np.zeros((size, _seen(loop)))
    wide[:, : looks.shape[0]] = looks.T
    return simd_copy(wide.reshape(size, -1, WIDTH))


def _seen(loop: NonlinearLoop) -> int:
    """How many numbers are seen, with what fills the last SIMD value."""
    return -(-(loop.motion.size + 4 * loop.linear.k_tot.size) // WIDTH) * WIDTH


def _steps(loop: NonlinearLoop, lengths_ns: Integers, halvings: int, work_tables: Floats) -> Steps | None:
    """Memory for the matrices of all lengths, and of their halves; None where it would be too much."""
    sets, n, d = loop.nonlinear.systems.shape
    steady, g = loop.nonlinear.steady, loop.nonlinear.weight.size
    rows, stages = (d, 1) if steady else (d + (ORDERS - 1) * g, 3)
    lengths = np.concatenate([lengths_ns * (1e-9 * 0.5**halving) for halving in range(halvings + 1)])
    slots = sets * lengths.size + 1
    if slots * stages * rows * n > LARGEST_TABLE:
        return None
    return Steps(
        np.empty((slots, stages, rows, n)),
        np.zeros(slots, dtype=np.int64),
        lengths,
        work_tables,
        np.empty((2, rows, n)),
        np.empty((d + 1, n)),
    )


@kept
def _repeating(spec: Spec, step: int, energies: bool) -> _Prepared | None:
    """Program of one hyperperiod; None where nothing repeats or the steps are too many."""
    loop, schedule = _loop(spec, energies), Schedule(spec)
    period = period_ns(spec, schedule, step)
    if loop is None or period is None:
        return None
    begin = -(-reach_ns(schedule) // period) * period
    operations = without_unused_samples(program(schedule, begin, begin + period, step))
    operations = operations._replace(time=operations.time - begin)
    lengths = np.diff(operations.time, prepend=operations.time[-1] - period)
    return _prepared(loop, *numbered(*split(operations, lengths, longest_step(loop)), period, loop))


def _prepared(loop: NonlinearLoop, operations: Operations, lengths: Integers) -> _Prepared | None:
    """A program with memory for its steps, and for their halves where these may be needed."""
    tables, halvings = tables_over(loop, lengths), 0 if loop.nonlinear.steady else HALVINGS
    steps = _steps(loop, lengths, halvings, tables) or _steps(loop, lengths, 0, tables)
    if steps is None:
        return None
    return _Prepared(operations, steps, packed(steps, loop.nonlinear, _columns(loop), lengths.size))


@kept
def _digit_steps(spec: Spec, energies: bool) -> Steps | None:
    """Memory for the steps over every digit of a length."""
    loop = _loop(spec, energies)
    return None if loop is None else _steps(loop, digit_lengths(), 0, tables_over_digits(loop))


def start_state(loop: NonlinearLoop, samples: int, references: int) -> State:
    """Start of a loop that looks back on so many samples and references."""
    z, seen = np.concatenate([loop.start, np.zeros(loop.nonlinear.weight.size)]), _seen(loop)
    past = Memory(
        filled(loop.linear.first_sample, samples),
        filled(loop.linear.first_reference, references),
        np.zeros(3, dtype=np.int64),
    )
    counting = bool(loop.forms.size)
    return State(z, work(loop.nonlinear, seen, counting=counting), past)


class Portion(NamedTuple):
    """A program to be run `passes` times, the memory of its steps, and how many rows come of it."""

    operations: Operations
    steps: Steps
    packed: Packed
    passes: int
    rows: int


class Plan(NamedTuple):
    """How far back a loop looks, in samples and references, and what it runs one after the other."""

    samples: int
    references: int
    portions: Iterator[Portion]


def plan(spec: Spec, loop: NonlinearLoop, end: int, step: int, *, energies: bool, span: int) -> Plan | None:
    """What gives rows every `step` ns up to `end` ns, in portions of about `span` ns; None where there is no
    fast way for it.
    """
    repeating = _repeating(spec, step, energies)
    if repeating is not None:
        backwards = int(repeating.operations.sample.max()), int(repeating.operations.reference.max())
        return Plan(*backwards, _repeated(repeating, end, step, span))
    steps, schedule = _digit_steps(spec, energies), Schedule(spec)
    if steps is None or step >= LONGEST_LENGTH:
        return None
    reach = reach_ns(schedule)
    portions = _irregular(schedule, loop, steps, end, step)
    return Plan(reach // schedule.td1, reach // schedule.td2, portions)


def nonlinear_blocks(
    spec: Spec, end: int, step: int, *, energies: bool, span: int = CHUNK_NS
) -> Iterator[Rows] | None:
    """Rows of a loop with laws that are not linear, every `step` ns up to `end` ns, in blocks of about `span`
    ns; None where there is no fast way for it.
    """
    loop = _loop(spec, energies)
    if loop is None or not loop.nonlinear.weight.size:
        return None
    found = plan(spec, loop, end, step, energies=energies, span=span)
    if found is None:
        return None
    state = start_state(loop, found.samples, found.references)
    return (_block(loop, _looks(spec, energies), portion, state) for portion in found.portions)


def _repeated(one: _Prepared, end: int, step: int, span: int) -> Iterator[Portion]:
    operations = one.operations
    period, times = operations.period, operations.time
    passes = max(1, -(-span // period))
    for begin in range(0, end + 1, passes * period):
        count = rows_within(begin, min(begin + passes * period, end + 1), step)
        left = min(passes, (end - begin) // period + 1)
        chosen = operations._replace(time=times + begin)
        if begin:
            chosen = chosen._replace(length=np.stack([operations.length[1]] * 2))
        yield Portion(chosen, one.steps, one.packed, left, count)


def _irregular(
    schedule: Schedule, loop: NonlinearLoop, steps: Steps, end: int, step: int
) -> Iterator[Portion]:
    arcs = not loop.forms.size or steps.work_tables.shape[0] > 0
    since, room = 0, packed(steps, loop.nonlinear, _columns(loop), steps.lengths.size)
    for begin in range(0, end + 1, CHUNK_NS):
        stop = min(begin + CHUNK_NS, end + 1)
        operations = program(schedule, begin, stop, step)
        if operations.time.size == 0:
            continue
        lengths = np.diff(operations.time, prepend=since)
        divided, _ = split(operations, lengths, longest_step(loop))
        chosen = in_digits(divided, since)
        since = int(operations.time[-1])
        numbers = step_by_step(chosen, chosen.plant, arcs=arcs)
        yield Portion(numbers, steps, room, 1, rows_within(begin, stop, step))


def rows_alone(loop: NonlinearLoop, count: int, step: int) -> Floats | None:
    """Positions and velocities (count, 2 n) of a plant without actuators, every `step` ns; None where the
    memory of the steps would be too large.
    """
    zero = np.zeros(1, dtype=np.int64)
    row = Program(zero + OUTPUT, zero, zero, zero, zero, zero)
    one = _prepared(loop, *numbered(*split(row, zero + step, longest_step(loop)), step, loop))
    if one is None:
        return None
    return _block(loop, looks_of(loop), Portion(*one, count, count), start_state(loop, 0, 0)).plant


def outputs(loop: NonlinearLoop, rows: int) -> Outputs:
    """Rows to be written."""
    m, n2, both = loop.linear.k_tot.size, loop.linear.numerical.y.size, loop.motion.size
    plant, numerical, reference = (np.empty((rows, width)) for width in (both - n2 + m, n2, m))
    work = np.empty((rows if loop.forms.size else 0, loop.forms.shape[0]))
    return Outputs(plant, numerical, reference, work)


def _block(loop: NonlinearLoop, looks: Looks, portion: Portion, state: State) -> Rows:
    """Run a portion and leave its last row, which is beyond the block: a full block would end the run."""
    out = outputs(loop, portion.rows + 1)
    state.memory.count[ROW_COUNT] = 0
    run_nonlinear(
        loop.nonlinear,
        portion.steps,
        portion.packed,
        state.work,
        looks,
        portion.operations,
        state.memory,
        state.z,
        portion.passes,
        out,
    )
    return Rows(*(rows[:-1] for rows in out))
