"""Simulate a loop whose plant has laws that are not linear: reduce it to a program and run the kernel."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers
from rthm_core.engine.digits import LONGEST_LENGTH, digit_lengths, in_digits, work_over_digits
from rthm_core.engine.linear.blocks import CHUNK_NS, Rows, rows_within
from rthm_core.engine.linear.kernel import ROW_COUNT, Memory
from rthm_core.engine.linear.ledger import LinearLedger, work_tables
from rthm_core.engine.linear.preparation import filled
from rthm_core.engine.nonlinear.advance import Work, work
from rthm_core.engine.nonlinear.kernel import Looks, Operations, Outputs, run_nonlinear
from rthm_core.engine.nonlinear.loop import NonlinearLoop, nonlinear_loop
from rthm_core.engine.nonlinear.steps import LONGEST_SERIES, ORDERS, Steps
from rthm_core.engine.program import (
    STEP,
    Program,
    period_ns,
    program,
    reach_ns,
)
from rthm_core.kept import kept
from rthm_core.physical.sensors import Sensors
from rthm_core.schedule import OUTPUT, Schedule
from rthm_core.simd import simd_copy

if TYPE_CHECKING:
    from rthm_core.spec import Spec

LARGEST_TABLE = 8_000_000
"""Most numbers in the matrices of the steps."""

SMOOTH = 0.5
"""Longest step, times the fastest mode, over which work is counted at once."""


class _Prepared(NamedTuple):
    """A program with its memory of steps."""

    operations: Operations
    steps: Steps


class State(NamedTuple):
    """What lasts from block to block."""

    z: Floats
    work: Work
    memory: Memory


@kept
def _loop(spec: Spec, energies: bool) -> NonlinearLoop | None:
    return nonlinear_loop(spec, energies=energies)


def looks_of(loop: NonlinearLoop) -> Looks:
    """What is seen of a loop."""
    upper = np.triu_indices(loop.nonlinear.systems.shape[2])
    double = np.where(upper[0] == upper[1], 1.0, 2.0)
    forms = np.empty((0, 0)) if not loop.forms.size else loop.forms[:, upper[0], upper[1]] * double
    none = Sensors(np.zeros((0, 5)), np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.uint64))
    linear = loop.linear
    return Looks(
        loop.sample,
        loop.force,
        loop.reference,
        loop.motion,
        linear.bias,
        linear.sensors or none,
        linear.k_tot,
        np.ascontiguousarray(forms),
    )


def _work_tables(loop: NonlinearLoop, lengths_ns: Integers | None) -> Floats:
    """Tables of the work for every set of sticking dofs and length, or for every digit of a length; empty
    where they are not counted or forces change within a step.
    """
    size, d = loop.nonlinear.systems.shape[1:]
    if not (loop.forms.size and loop.nonlinear.steady):
        return np.empty((0, 0, 0))
    ledgers = [
        LinearLedger(loop.linear, np.vstack([system, np.zeros((d - size, d))]), loop.forms)
        for system in loop.nonlinear.systems
    ]
    none = np.zeros(0, dtype=np.int64)
    if lengths_ns is None:
        return simd_copy(np.concatenate([work_over_digits(one)[:-1] for one in ledgers]))
    return simd_copy(np.concatenate([work_tables(one, lengths_ns, none) for one in ledgers]))


def _steps(loop: NonlinearLoop, lengths_ns: Integers, work_tables: Floats) -> Steps | None:
    """Memory for the matrices of all lengths; None where it would be too much."""
    sets, n, d = loop.nonlinear.systems.shape
    g, steady = loop.nonlinear.input_matrix.shape[1], loop.nonlinear.steady
    rows, stages, slots = (
        d if steady else d + (ORDERS - 1) * g,
        1 if steady else 3,
        sets * lengths_ns.size + 1,
    )
    if slots * stages * rows * n > LARGEST_TABLE:
        return None
    return Steps(
        np.empty((slots, stages, rows, n)),
        np.zeros(slots, dtype=np.int64),
        np.asarray(lengths_ns * 1e-9, dtype=float),
        work_tables,
        np.empty((2, rows, n)),
        np.empty((d + 1, n)),
    )


def _split(operations: Program, lengths: Integers, longest: int) -> tuple[Program, Integers]:
    """The program, and its `lengths` since the operation before, with a `STEP` wherever one would be above
    `longest` ns.
    """
    parts = np.maximum(-(-lengths // longest), 1)
    which, last = np.repeat(np.arange(parts.size), parts), np.cumsum(parts) - 1
    split = np.full(which.size, longest)
    split[last] = lengths - (parts - 1) * longest
    chosen = Program(*(column[which] for column in operations))
    what = np.full(which.size, STEP)
    what[last] = operations.what
    time = operations.time[0] - lengths[0] + np.cumsum(split)
    return chosen._replace(what=what, time=time), split


def _operations(
    chosen: Program, first: Integers, further: Integers, period: int
) -> tuple[Operations, Integers]:
    """Operations of a program with the lengths of its first and every further pass; the different lengths."""
    both = np.stack([first, further])
    lengths, which = np.unique(both[both > 0], return_inverse=True)
    numbers = np.full(both.shape, -1, dtype=np.int64)
    numbers[both > 0] = which
    return Operations(chosen.what, chosen.time, numbers, chosen.sample, chosen.reference, period), lengths


def _longest(loop: NonlinearLoop) -> int:
    """Longest step in ns."""
    smooth = SMOOTH if loop.forms.size else LONGEST_SERIES
    fastest = max(loop.nonlinear.fastest, 1e-3)
    return max(int(smooth / fastest * 1e9), 1000)


@kept
def _repeating(spec: Spec, step: int, energies: bool) -> _Prepared | None:
    """Program of one hyperperiod; None where nothing repeats or the steps are too many."""
    loop, schedule = _loop(spec, energies), Schedule(spec)
    period = period_ns(spec, schedule, step)
    if loop is None or period is None:
        return None
    begin = -(-reach_ns(schedule) // period) * period
    operations = program(schedule, begin, begin + period, step)
    operations = operations._replace(time=operations.time - begin)
    lengths = np.diff(operations.time, prepend=operations.time[-1] - period)
    chosen, further = _split(operations, lengths, _longest(loop))
    first = np.where(chosen.time <= 0, 0, further)
    numbered, different = _operations(chosen, first, further, period)
    steps = _steps(loop, different, _work_tables(loop, different))
    return None if steps is None else _Prepared(numbered, steps)


@kept
def _digit_steps(spec: Spec, energies: bool) -> Steps | None:
    """Memory for the steps over every digit of a length."""
    loop = _loop(spec, energies)
    return None if loop is None else _steps(loop, digit_lengths(), _work_tables(loop, None))


def start_state(loop: NonlinearLoop, samples: int, references: int) -> State:
    """Start of a loop that looks back on so many samples and references."""
    _, n, d = loop.nonlinear.systems.shape
    g = loop.nonlinear.input_matrix.shape[1]
    orders = 1 if loop.nonlinear.steady else ORDERS
    z = np.concatenate([loop.start, np.zeros(g)])
    past = Memory(
        filled(loop.linear.first_sample, samples),
        filled(loop.linear.first_reference, references),
        np.zeros(3, dtype=np.int64),
    )
    counting = bool(loop.forms.size)
    return State(z, work(n, d, g, orders, loop.nonlinear.modes, counting=counting), past)


class Portion(NamedTuple):
    """A program to be run `passes` times, the memory of its steps, and how many rows come of it."""

    operations: Operations
    steps: Steps
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
    if loop is None or not loop.nonlinear.modes.size:
        return None
    found = plan(spec, loop, end, step, energies=energies, span=span)
    if found is None:
        return None
    state = start_state(loop, found.samples, found.references)
    return (_block(loop, portion, state) for portion in found.portions)


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
        yield Portion(chosen, one.steps, left, count)


def _irregular(
    schedule: Schedule, loop: NonlinearLoop, steps: Steps, end: int, step: int
) -> Iterator[Portion]:
    since = 0
    for begin in range(0, end + 1, CHUNK_NS):
        stop = min(begin + CHUNK_NS, end + 1)
        operations = program(schedule, begin, stop, step)
        if operations.time.size == 0:
            continue
        lengths = np.diff(operations.time, prepend=since)
        split, _ = _split(operations, lengths, _longest(loop))
        chosen = in_digits(split, since)
        since = int(operations.time[-1])
        numbers = np.stack([chosen.plant, chosen.plant])
        numbered = Operations(chosen.what, chosen.time, numbers, chosen.sample, chosen.reference, 0)
        yield Portion(numbered, steps, 1, rows_within(begin, stop, step))


def rows_alone(loop: NonlinearLoop, count: int, step: int) -> Floats | None:
    """Positions and velocities (count, 2 n) of a plant without actuators, every `step` ns; None where the
    memory of the steps would be too large.
    """
    zero = np.zeros(1, dtype=np.int64)
    row = Program(zero + OUTPUT, zero, zero, zero, zero, zero)
    chosen, further = _split(row, zero + step, _longest(loop))
    operations, lengths = _operations(chosen, np.zeros_like(further), further, step)
    steps = _steps(loop, lengths, np.empty((0, 0, 0)))
    if steps is None:
        return None
    return _block(loop, Portion(operations, steps, count, count), start_state(loop, 0, 0)).plant


def outputs(loop: NonlinearLoop, rows: int) -> Outputs:
    """Rows to be written."""
    m, n2, both = loop.linear.k_tot.size, loop.linear.numerical.y.size, loop.motion.size
    plant, numerical, reference = (np.empty((rows, width)) for width in (both - n2 + m, n2, m))
    work = np.empty((rows if loop.forms.size else 0, loop.forms.shape[0]))
    return Outputs(plant, numerical, reference, work)


def _block(loop: NonlinearLoop, portion: Portion, state: State) -> Rows:
    """Run a portion and leave its last row, which is beyond the block: a full block would end the run."""
    out = outputs(loop, portion.rows + 1)
    state.memory.count[ROW_COUNT] = 0
    run_nonlinear(
        loop.nonlinear,
        portion.steps,
        state.work,
        looks_of(loop),
        portion.operations,
        state.memory,
        state.z,
        portion.passes,
        out,
    )
    return Rows(*(rows[:-1] for rows in out))
