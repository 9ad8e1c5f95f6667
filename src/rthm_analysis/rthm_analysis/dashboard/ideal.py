"""The ideal system beside a running test."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_core.engine import simulate
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec

FIRST, LONGEST = 64.0, 3600.0
"""How far the ideal motion is computed at first, and at most, s."""


class IdealMotion:
    """Motion of the plant in the ideal system, computed as far ahead as it is asked for.

    Parameters
    ----------
    spec : Spec
        A loop.
    step : float
        Distance of the rows, s; row k is at k step.

    Attributes
    ----------
    why : str
        Why there is no ideal motion any more; empty: there is.
    """

    def __init__(self, spec: Spec, step: float) -> None:
        self._spec, self._step, self.why = spec, step, ""
        self._span = FIRST / 2.0
        self._motion = np.empty((0, len(spec.plant.dofs)))

    def rows(self, first: int, stop: int) -> Floats:
        """Positions (stop - first, n) of the rows from `first` on, m; NaN where they are not known."""
        while stop > len(self._motion) and not self.why:
            self._extend()
        found = np.full((stop - first, self._motion.shape[1]), np.nan)
        there = self._motion[first:stop]
        found[: len(there)] = there
        return found

    def _extend(self) -> None:
        """Begin anew for twice the time: exact steps are so cheap that all of them cost less than drawing."""
        self._span *= 2.0
        if self._span > LONGEST:
            self.why = f"the ideal system is computed for the first {LONGEST / 60.0:.0f} min only"
            return
        try:
            self._motion = simulate(
                self._spec, self._span, self._step, "ideal", energies=False
            ).plant_position
        except InputError as error:
            self.why = str(error)
