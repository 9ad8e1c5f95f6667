"""What this process costs the host."""

from __future__ import annotations

import os
import time

LOWEST = 19
"""Niceness of the lowest priority."""


def step_back() -> None:
    """Give this process the lowest priority of all that compute."""
    os.nice(LOWEST - os.nice(0))


class Cost:
    """Share of one processor core that this process takes, over the last seconds.

    Parameters
    ----------
    over : float
        Seconds.
    """

    def __init__(self, over: float = 2.0) -> None:
        self._over, self._share = over, 0.0
        self._wall, self._cpu = time.monotonic(), time.process_time()

    def share(self) -> float:
        """Seconds of computing per second."""
        wall = time.monotonic()
        if wall - self._wall >= self._over:
            cpu = time.process_time()
            self._share = round((cpu - self._cpu) / (wall - self._wall), 4)
            self._wall, self._cpu = wall, cpu
        return self._share
