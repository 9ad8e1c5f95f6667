"""When the work of a program that repeats is looked at, and coefficients of the products it is made of."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Flags, Floats, Integers
from rthm_core.energy import FF, FX
from rthm_core.engine.linear.kernel import Operations
from rthm_core.engine.linear.ledger import COLUMNS, LinearLedger, pairs, work_and_energy
from rthm_core.engine.linear.periods import PRODUCTS, SIDE_BY_SIDE, Looks, Periods
from rthm_core.schedule import OUTPUT
from rthm_core.simd import WIDTH, simd_empty

NO_TERM = COLUMNS - 1
"""Place that no term has."""

ENOUGH_ALONE = 8
"""So many pairs that matter for one term alone are worth a segment."""


def periods_of(
    ledger: LinearLedger, plant: int, operations: Operations, moves: Integers, rows: Integers
) -> Periods:
    """How work is counted in a program whose tables are numbered: those of the lengths (ns) of moves, then
    those of rows. The first so many elements of the joint state are of the plant's side.
    """
    looks = _looks(work_and_energy(ledger, moves, rows), plant, operations)
    states = simd_empty(looks.ends.size, ledger.joint.shape[0], WIDTH)
    sums = simd_empty(looks.row.size + 1, WIDTH, WIDTH)
    states[...] = sums[0] = 0.0
    return Periods(
        looks, states, simd_empty(PRODUCTS, WIDTH), sums, simd_empty(WIDTH + 1, WIDTH), np.zeros(COLUMNS)
    )


def only_further(periods: Periods) -> Periods:
    """The same where every period is a further one."""
    table = periods.looks.table[1]
    return periods._replace(looks=periods.looks._replace(table=np.stack([table, table])))


class Segment(NamedTuple):
    """Pairs of elements of the joint state, and the terms for which all of them matter; a term `alone` takes
    four pairs at a time instead.
    """

    pairs: Integers
    terms: Integers
    alone: bool


def _looks(forms: Floats, plant: int, operations: Operations) -> Looks:
    forms[:, FF] += forms[:, FX]
    segments = list(_segments(forms, plant))
    coefficients = [_coefficients(forms, segment) for segment in segments]
    first, second, _ = pairs(forms.shape[-1])
    chosen = np.concatenate([segment.pairs for segment in segments])
    ends = np.cumsum([0, *(segment.pairs.size for segment in segments)])
    begins = np.cumsum([0, *(values.shape[1] for values in coefficients)])[:-1]
    alone = [segment.alone for segment in segments]
    terms = np.stack([segment.terms for segment in segments])
    return Looks(
        np.ascontiguousarray(np.concatenate(coefficients, axis=1)),
        np.stack([first[chosen], second[chosen]]),
        np.column_stack([ends[:-1], ends[1:], begins, alone, terms]),
        *_instants(operations),
    )


def _segments(forms: Floats, plant: int) -> Iterator[Segment]:
    """Pairs of elements of the plant's side, and those with one of the numerical side: each with the terms
    that they matter for, a few at a time.
    """
    first, second, _ = pairs(forms.shape[-1])
    matters = (forms[..., first, second] != 0.0).any(axis=0)
    both = second >= plant
    for block in (~both, both):
        sizes = matters[:, block].sum(axis=1)
        terms = np.argsort(-sizes, kind="stable")[: np.count_nonzero(sizes)]
        for begin in range(0, terms.size, SIDE_BY_SIDE):
            yield from _of_some(matters & block, terms[begin : begin + SIDE_BY_SIDE])


def _of_some(matters: Flags, terms: Integers) -> Iterator[Segment]:
    """Segment of up to four terms, and one for each of them that many pairs matter for alone."""
    several = matters[terms].sum(axis=0)
    for term in terms:
        alone = np.flatnonzero(matters[term] & (several == 1))
        if alone.size >= ENOUGH_ALONE:
            several[alone] = 0
            padded = np.pad(alone, (0, -alone.size % SIDE_BY_SIDE), mode="edge")
            yield Segment(padded, np.full(SIDE_BY_SIDE, term), True)
    which = np.flatnonzero(several)
    if which.size:
        padded = np.pad(terms, (0, SIDE_BY_SIDE - terms.size), constant_values=NO_TERM)
        yield Segment(which, padded, False)


def _coefficients(forms: Floats, segment: Segment) -> Floats:
    """Coefficients (K, ., 4) of the pairs of a segment for its terms."""
    first, second, double = (side[segment.pairs] for side in pairs(forms.shape[-1]))
    there = segment.terms != NO_TERM
    values = np.zeros((forms.shape[0], SIDE_BY_SIDE, first.size))
    values[:, there] = forms[:, segment.terms[there]][..., first, second] * double
    if not segment.alone:
        return np.swapaxes(values, 1, 2)
    fresh = np.diff(segment.pairs, prepend=-1) > 0
    return (values[:, 0] * fresh).reshape(forms.shape[0], -1, SIDE_BY_SIDE)


def _instants(operations: Operations) -> tuple[Integers, Integers, Integers, int]:
    """Table of each look, ends of the looks between changes, rows of looks, and their number."""
    work = operations.work.reshape(2, -1)
    what = np.flatnonzero((operations.what == OUTPUT) | (work[0] >= 0))
    written = operations.what[what] == OUTPUT
    row, rows = np.cumsum(written) - 1, int(written.sum())
    after = np.flatnonzero(~written)[-1] + 1
    table = np.ascontiguousarray(np.hstack([work[[1, 1]][:, what[after:]], work[:, what[:after]]]))
    ends = np.flatnonzero(~np.roll(written, -after)) + 1
    return table, np.concatenate([[0], ends]), np.concatenate([row[after:] - rows, row[:after]]), rows
