"""Rows of a curve that grows, of which the newest are kept."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from itertools import islice

from rthm_analysis.dashboard.digits import rounded

Row = list[float | None]


class Trace:
    """The newest rows of a curve, numbered from 0 on, so that everybody who draws it can ask for what is new.

    Parameters
    ----------
    kept : int
        How many rows are kept.

    Examples
    --------
    >>> trace = Trace(2)
    >>> trace.extend([[0.0, 1.0], [0.1, 2.0], [0.2, 3.0]])
    >>> trace.after(2), trace.after(0)
    ([[0.2, 3.0]], [[0.1, 2.0], [0.2, 3.0]])
    """

    def __init__(self, kept: int) -> None:
        self._rows: deque[Row] = deque(maxlen=kept)
        self.count = 0

    def extend(self, rows: Iterable[Sequence[float]]) -> None:
        """Add rows; what is not finite becomes None."""
        for row in rows:
            self._rows.append([rounded(value) for value in row])
            self.count += 1

    def clear(self) -> None:
        """Forget all rows, but not how many there were."""
        self._rows.clear()

    def after(self, number: int) -> list[Row]:
        """Rows from this number on, as far as they are kept."""
        new = min(self.count - number, len(self._rows))
        return list(islice(self._rows, len(self._rows) - new, None))
