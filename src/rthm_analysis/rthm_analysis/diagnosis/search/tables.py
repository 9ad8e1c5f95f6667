"""Products of all columns, from which what any combination of pieces would leave is solved, many at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.search import COMBINATION_RIDGE, COMBINATIONS_AT_ONCE
from rthm_analysis.diagnosis.search.pieces import Piece, is_plain
from rthm_core.compiled import Flags, Floats, Integers


class Traits(NamedTuple):
    """What decides whether pieces can stand beside each other: arrays (k,) over the pieces.

    Attributes
    ----------
    columns : Integers
        How many columns each has.
    there, stays, plain, bends, positive : Flags
        As in `Piece`; `positive` where its size cannot be negative.
    single : Integers
        Number of what there can only be one of, as `InitialGuess.single`; -1: there can be others.
    """

    columns: Integers
    there: Flags
    stays: Flags
    plain: Flags
    bends: Flags
    positive: Flags
    single: Integers

    def possible(self, count: int) -> Integers:
        """Combinations (N, count) that can be: of what could be anything only one is looked for."""
        every = list(combinations(range(self.columns.size), count))
        some = np.array(every, dtype=np.int64).reshape(-1, count)
        single = self.single[some]
        alone = np.ones(len(some), dtype=bool)
        for one, other in combinations(range(count), 2):
            alone &= (single[:, one] < 0) | (single[:, one] != single[:, other])
        alone &= self.bends[some].sum(axis=1) <= 1
        kept = alone & (self.stays[some].sum(axis=1) == self.stays.sum())
        return np.asarray(some[kept])


def traits_of(pieces: Sequence[Piece]) -> Traits:
    """Traits of some pieces."""
    numbers: dict[tuple[str, str] | None, int] = {None: -1}
    single = [numbers.setdefault(one.start.single, len(numbers)) for one in pieces]

    def flags(found: Iterator[bool]) -> Flags:
        return np.fromiter(found, dtype=bool, count=len(pieces))

    return Traits(
        np.array([len(one.columns) for one in pieces], dtype=np.int64),
        flags(one.index is not None for one in pieces),
        flags(one.stays for one in pieces),
        flags(is_plain(one.start) for one in pieces),
        flags(one.bends for one in pieces),
        flags(one.is_positive for one in pieces),
        np.array(single, dtype=np.int64),
    )


class Tables:
    """What combinations of some pieces would leave.

    Parameters
    ----------
    known : (q, u k) array
        Columns of what is uncertain in the spec.
    precision : (q,) array
    here : (u k,) array
        Residual.
    pieces : list of Piece
    """

    def __init__(self, known: Floats, precision: Floats, here: Floats, pieces: Sequence[Piece]) -> None:
        columns = np.vstack([*(one.columns for one in pieces), *(one.whole for one in pieces), here])
        self.traits = traits_of(pieces)
        ends = np.cumsum([0, *self.traits.columns])
        self._starts = ends[:-1]
        self._present = np.flatnonzero(self.traits.there)
        self._targets = np.append(ends[-1] + self._present, len(columns) - 1)
        shared = columns @ known.T
        whole = known @ known.T + np.diag(precision)
        self._products = columns @ columns.T - shared @ np.linalg.pinv(whole, hermitian=True) @ shared.T
        self._products[np.diag_indices_from(self._products)] *= 1.0 + COMBINATION_RIDGE

    def in_parts(self, some: Integers) -> Iterator[Integers]:
        """Combinations (N, c) in parts, in each of which all have as many columns, piece by piece."""
        widths, which = np.unique(self.traits.columns[some], axis=0, return_inverse=True)
        for width in range(len(widths)):
            alike = some[which.ravel() == width]
            for at in range(0, len(alike), COMBINATIONS_AT_ONCE):
                yield alike[at : at + COMBINATIONS_AT_ONCE]

    def left(self, some: Integers) -> tuple[Floats, Floats]:
        """Squared error (N,) that combinations (N, c) of as many columns, piece by piece, leave, and the
        factors (N, q) on their columns.
        """
        widths = self.traits.columns[some[0]]
        own = np.hstack([self._starts[some[:, [i]]] + np.arange(width) for i, width in enumerate(widths)])
        asked = np.ones((len(some), self._targets.size))  # what is left now, and what of it would go
        asked[:, :-1] = ~(some[:, :, None] == self._present).any(axis=1)
        seen = (self._products[own[:, :, None], self._targets] @ asked[:, :, None])[..., 0]
        found = np.linalg.solve(self._products[own[:, :, None], own[:, None, :]], seen[..., None])[..., 0]
        whole = ((asked @ self._products[np.ix_(self._targets, self._targets)]) * asked).sum(axis=1)
        return whole - (found * seen).sum(axis=1), found

    def may_have(self, some: Integers, sizes: Floats) -> Flags:
        """Of such combinations (N,), whether none of their sizes (N, q) is negative that cannot be."""
        widths, wrong = self.traits.columns[some[0]], np.zeros(len(some), dtype=bool)
        for i in np.flatnonzero(widths == 1):
            wrong |= self.traits.positive[some[:, i]] & ~(sizes[:, widths[:i].sum()] > 0.0)
        return ~wrong
