"""A program with the lengths of its steps, which are numbered, and its arcs.

An arc is what lies between two changes of an input: rows and samples only look at the motion on its way, so
that one step can span it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Integers
from rthm_core.engine.nonlinear.loop import NonlinearLoop
from rthm_core.engine.nonlinear.steps import LONGEST_SERIES
from rthm_core.engine.program import STEP, Program
from rthm_core.schedule import MOTOR, REFERENCE

SMOOTH = 0.5
"""Longest step, times the fastest mode, over which work is counted at once."""

LONGEST_ARC = 1.0
"""Longest arc, times the fastest mode: within it, a motion that turns does so once."""


class Operations(NamedTuple):
    """Program: arrays (operations,), and (2, operations) for the first and for every further pass.

    `length` is the number of the length since the operation before, and `span` that of the length since the
    beginning of its arc, -1: none; `last` is the last operation of the arc that begins with an operation, -1:
    none does.
    """

    what: Integers
    time: Integers
    length: Integers
    sample: Integers
    reference: Integers
    span: Integers
    last: Integers
    period: int


def split(operations: Program, lengths: Integers, longest: int) -> tuple[Program, Integers]:
    """The program, and its `lengths` since the operation before, with a `STEP` wherever one would be above
    `longest` ns.
    """
    parts = np.maximum(-(-lengths // longest), 1)
    which, last = np.repeat(np.arange(parts.size), parts), np.cumsum(parts) - 1
    divided = np.full(which.size, longest)
    divided[last] = lengths - (parts - 1) * longest
    chosen = Program(*(column[which] for column in operations))
    what = np.full(which.size, STEP)
    what[last] = operations.what
    time = operations.time[0] - lengths[0] + np.cumsum(divided)
    return chosen._replace(what=what, time=time), divided


def longest_step(loop: NonlinearLoop) -> int:
    """Longest step in ns."""
    return _longest(loop, SMOOTH if loop.forms.size else LONGEST_SERIES)


def _longest(loop: NonlinearLoop, phase: float) -> int:
    return max(int(phase / max(loop.nonlinear.fastest, 1e-3) * 1e9), 1000)


def numbered(
    chosen: Program, further: Integers, period: int, loop: NonlinearLoop
) -> tuple[Operations, Integers]:
    """Operations of a program that repeats, with the lengths since the operation before; the different
    lengths. A test begins within its first pass, in which there are no arcs.
    """
    first = np.where(chosen.time <= 0, 0, further)
    span, last = _arcs(chosen.what, further, _longest(loop, SMOOTH if loop.forms.size else LONGEST_ARC))
    every = np.stack([first, further, np.zeros_like(span), span])
    lengths, which = np.unique(every[every > 0], return_inverse=True)
    numbers = np.full(every.shape, -1, dtype=np.int64)
    numbers[every > 0] = which
    lasts = np.stack([np.full_like(last, -1), last])
    return (
        Operations(
            chosen.what, chosen.time, numbers[:2], chosen.sample, chosen.reference, numbers[2:], lasts, period
        ),
        lengths,
    )


def step_by_step(chosen: Program, numbers: Integers, *, arcs: bool) -> Operations:
    """Operations of a program that does not repeat, with the numbers of its lengths, of which each is an arc
    or none is.
    """
    both = np.stack([numbers, numbers])
    last = np.where(arcs & (both >= 0), np.arange(numbers.size), -1)
    return Operations(chosen.what, chosen.time, both, chosen.sample, chosen.reference, both, last, 0)


def _arcs(what: Integers, lengths: Integers, longest: int) -> tuple[Integers, Integers]:
    """Length, in ns, since the beginning of each operation's arc, and the last operation of each arc at its
    first.
    """
    span, last = np.zeros_like(lengths), np.full(lengths.size, -1, dtype=np.int64)
    changes = (what == MOTOR) | (what == REFERENCE) | (what == STEP)
    begin, since = 0, 0
    for e, length in enumerate(lengths):
        if since + length > longest:
            begin, since = e, 0
        since += int(length)
        span[e] = since
        if since > 0:
            last[begin] = e
        if changes[e]:
            begin, since = e + 1, 0
    return span, last
