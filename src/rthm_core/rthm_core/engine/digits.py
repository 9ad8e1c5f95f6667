"""Steps of any length, put together from few: a length in ns by its digits to the base 256."""

from __future__ import annotations

import numpy as np

from rthm_core.compiled import Floats, Integers, compiled
from rthm_core.engine.linear.ledger import LinearLedger, packed, work_over
from rthm_core.engine.program import STEP, Program
from rthm_core.exponential import exponentials

BITS, PLACES = 8, 4
BASE = 1 << BITS
LONGEST_LENGTH = 1 << BITS * PLACES
"""Lengths must be below this, in ns."""


def digit_lengths() -> Integers:
    """Length in ns of every digit (BASE) at every place (PLACES), place by place."""
    return (np.arange(BASE)[None] << BITS * np.arange(PLACES)[:, None]).ravel()


@compiled
def _write_digits(time: Integers, since: int, which: Integers, numbers: Integers, at: Integers) -> int:
    """Write, for each step and operation, the operation it belongs to, its number and its instant; their
    count.
    """
    count, now = 0, since
    for e in range(time.size):
        for place in range(PLACES):
            digit = (time[e] - since) >> BITS * place & BASE - 1
            if digit:
                now += digit << BITS * place
                which[count], numbers[count], at[count] = e, BASE * place + digit, now
                count += 1
        since = time[e]
        which[count], numbers[count], at[count] = e, -1, since
        count += 1
    return count


def in_digits(operations: Program, since: int) -> Program:
    """The program with a `STEP` for every digit of the time since the operation before, the first of them
    after `since` (ns).

    `plant` and `numerical` become the number of the step's length in `digit_lengths`, -1 for an operation
    itself.
    """
    written = np.empty((3, operations.time.size * (PLACES + 1)), dtype=np.int64)
    count = _write_digits(operations.time, since, *written)
    which, numbers, at = written[:, :count]
    what = np.where(numbers < 0, operations.what[which], STEP)
    return Program(what, at, numbers, numbers, operations.sample[which], operations.reference[which])


def work_over_digits(ledger: LinearLedger) -> Floats:
    """Tables of the work over each of `digit_lengths`, and last one with the energy of the present state.

    ``W(s + t) = W(t) + E(t)' W(s) E(t)`` for the forms W of the work and the step E.
    """
    d, terms = ledger.joint.shape[0], ledger.forms.shape[0] - 1
    forms = np.zeros((PLACES, BASE, terms, d, d))
    unit = work_over(ledger, np.ones(1, dtype=np.int64))[0]
    for place in range(PLACES):
        steps = exponentials(ledger.joint, np.left_shift(1, BITS * place + np.arange(BITS)))
        for bit, step in enumerate(steps):
            half = 1 << bit
            earlier = np.swapaxes(step, 0, 1) @ forms[place, :half] @ step
            forms[place, half : 2 * half] = unit + earlier
            unit = unit + np.swapaxes(step, 0, 1) @ unit @ step
    present = np.zeros_like(ledger.forms[None])
    present[:, terms] = ledger.forms[terms]
    return np.concatenate([packed(forms.reshape(-1, terms, d, d)), packed(present)])
