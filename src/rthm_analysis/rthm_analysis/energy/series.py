"""Samples of one topic that wait to be counted: added in any order, handed out in time order."""

from __future__ import annotations

import numpy as np

from rthm_core.compiled import Floats, Integers


class Series:
    """Stamped rows, sorted by stamp; of two with the same keys the one that came last counts.

    Parameters
    ----------
    width : int
        Numbers in a row.
    """

    def __init__(self, width: int) -> None:
        self._stamps = [np.empty(0, dtype=np.int64)]
        self._rows = [np.empty((0, width))]
        self._sorted = True

    def add(self, stamps_ns: Integers, rows: Floats) -> None:
        """Add rows of shape (n, width)."""
        if stamps_ns.size:
            self._stamps.append(stamps_ns)
            self._rows.append(rows)
            self._sorted = False

    @property
    def stamps(self) -> Integers:
        """All stamps, ascending, ns."""
        self._sort()
        return self._stamps[0]

    @property
    def rows(self) -> Floats:
        """All rows, in the order of their stamps."""
        self._sort()
        return self._rows[0]

    def forget(self, before_ns: int) -> None:
        """Drop all rows before an instant but the newest of them."""
        first = max(int(np.searchsorted(self.stamps, before_ns)) - 1, 0)
        if first:
            self._stamps, self._rows = [self.stamps[first:].copy()], [self.rows[first:].copy()]

    def _sort(self) -> None:
        if self._sorted:
            return
        stamps, rows = np.concatenate(self._stamps), np.concatenate(self._rows)
        order = np.argsort(stamps, kind="stable")
        last = np.append(np.diff(stamps[order]) != 0, True)[: order.size]
        self._stamps, self._rows, self._sorted = [stamps[order[last]]], [rows[order[last]]], True


class Uses:
    """Uses of one link: which sample was used when, in time order."""

    def __init__(self) -> None:
        self._pairs = [np.empty((0, 2), dtype=np.int64)]

    def add(self, use_ns: Integers, sample_ns: Integers) -> None:
        """Add uses."""
        if use_ns.size:
            self._pairs.append(np.column_stack([use_ns, sample_ns]))

    @property
    def pairs(self) -> Integers:
        """Instants of use and stamps of the samples used, (n, 2), ns."""
        if len(self._pairs) > 1:
            self._pairs = [np.unique(np.concatenate(self._pairs), axis=0)]
        return self._pairs[0]

    def forget(self, before_ns: int) -> None:
        """Drop all uses before an instant."""
        first = int(np.searchsorted(self.pairs[:, 0], before_ns))
        self._pairs = [self.pairs[first:].copy()]
