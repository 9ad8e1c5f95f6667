"""The rate of a command, held in real time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rthm_core.clock import NS

Floats = NDArray[np.float64]

ROUNDING = 4.0 * float(np.finfo(float).eps)
"""Excess that is rounding and passes, as a share of the command: what was limited once is not again."""


class Slew:
    """Largest step of a command, by the time since the last one.

    The time counts that really passed, at most the time between the stamps, at most one period: commands that
    come in a burst do not add up to a jump, and neither does the first one after a pause.

    Parameters
    ----------
    rate
        Largest rate, m/s; None: any.
    value
        Command (m,) from which the first one steps, m.
    period
        Longest time that counts, ns.
    """

    def __init__(self, rate: float | None, value: Floats, period: int) -> None:
        self._rate, self._period = rate, period
        self.value = value.copy()
        self._at = self._now = 0

    def to(self, wanted: Floats, at: int, now: int) -> Floats:
        """Go towards `wanted` (m,), as far as is allowed.

        Parameters
        ----------
        at, now
            Instant to which the command belongs, and the present, ns after the start.
        """
        if self._rate is not None:
            passed = min(at - self._at, now - self._now, self._period)
            step = self._rate * max(passed, 0) / NS
            off = np.abs(wanted - self.value) > step + ROUNDING * np.abs(self.value)
            if off.any():
                wanted = np.where(off, np.clip(wanted, self.value - step, self.value + step), wanted)
        self.value, self._at, self._now = wanted, at, now
        return wanted
