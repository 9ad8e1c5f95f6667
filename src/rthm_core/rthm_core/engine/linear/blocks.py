"""Rows of a linear loop, a span of time at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from rthm_core.compiled import Floats
from rthm_core.engine.linear.kernel import ROW_COUNT, Counting, run
from rthm_core.engine.linear.ledger import COLUMNS
from rthm_core.engine.linear.loop import LinearLoop
from rthm_core.engine.linear.preparation import Prepared, Start, widths
from rthm_core.simd import simd_empty

CHUNK_NS = 10_000_000_000
"""Span of time that is held at once where a run is given in blocks, or where nothing repeats."""


class Rows(NamedTuple):
    """What the kernel writes, N rows each.

    Plant (N, 2 n1 + m), numerical side (N, 2 n2), F_d in use (N, m), work and energy (N, 8), which has no
    rows when they are not counted.
    """

    plant: Floats
    numerical: Floats
    reference: Floats
    work: Floats


def empty_rows(loop: LinearLoop, count: int, *, energies: bool) -> Rows:
    """Rows to be written."""
    plant, numerical, reference = (np.empty((count, width)) for width in widths(loop))
    return Rows(plant, numerical, reference, simd_empty(count if energies else 0, COLUMNS))


def run_program(one: Prepared, start: Start, passes: int, rows: Rows) -> tuple[Any, ...]:
    """Run a program from a start, whose memory it changes; the state at its end."""
    counting = None if one.work_tables is None else Counting(one.work_tables, start.work, start.joint)
    periods = None if one.periods is None else one.periods._replace(work=start.work)
    plant, command, numerical, held, aside, commands = start.state
    return run(
        one.tables,
        one.operations,
        start.memory,
        start.sensors,
        counting,
        periods,
        plant,
        command,
        numerical,
        held,
        aside,
        commands,
        passes,
        tuple(rows),
        start.widths,
        start.scratch,
    )


def run_block(one: Prepared, start: Start, passes: int, rows: Rows) -> tuple[Rows, Start]:
    """Run a program and leave its last row, which is beyond the block: a full block would end the run."""
    start.memory.count[ROW_COUNT] = 0
    state = run_program(one, start, passes, rows)
    return Rows(*(array[:-1] for array in rows)), start._replace(state=state)


def joined(blocks: Sequence[Sequence[Floats]]) -> list[Floats]:
    """Arrays of all blocks, one after the other."""
    return [arrays[0] if len(arrays) == 1 else np.concatenate(arrays) for arrays in zip(*blocks, strict=True)]


def rows_within(begin: int, stop: int, step: int) -> int:
    """Number of rows in [begin, stop)."""
    return -(-stop // step) - -(-begin // step)
