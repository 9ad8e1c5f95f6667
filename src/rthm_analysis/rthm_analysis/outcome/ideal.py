"""How far the motion of a test is from that of the ideal system: no delays, no holds, no actuator."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.outcome.cycles import energy_per_cycle
from rthm_core.clock import NS, to_ns
from rthm_core.engine import Trajectory, simulate
from rthm_core.engine.simulate import checked_step

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec

INSTANTS_COMPARED = 100_000
"""Instants at which a motion is compared, about."""


@dataclass(frozen=True)
class IdealError:
    """Error of one dof of the plant against the ideal system.

    Attributes
    ----------
    nrmse : float
        Root mean square error over the root mean square of the ideal motion.
    largest : float
        m.
    """

    nrmse: float
    largest: float

    def as_dict(self) -> dict[str, float]:
        """Contract, section 5."""
        return {"nrmse": self.nrmse, "max": self.largest}


class IdealComparison:
    """Gathers the error of a simulated test from its blocks.

    Parameters
    ----------
    spec : Spec
        A loop.
    duration : float
        s.
    sample : float, optional
        Distance of the rows of the test, s.

    Attributes
    ----------
    motion : Trajectory
        Of the ideal system.
    """

    def __init__(self, spec: Spec, duration: float, sample: float | None = None) -> None:
        step = checked_step(spec, duration, sample)
        self._every = max(1, math.ceil(to_ns(duration) // step / INSTANTS_COMPARED))
        self._dofs = spec.plant.dofs if spec.plant else ()
        ideal = simulate(spec, duration, step * self._every / NS, "ideal", energies=False)
        self.motion = ideal
        self._ideal = ideal.plant_position
        self._error = np.zeros_like(self._ideal)
        self._work = np.full(len(ideal.t), np.nan)
        self._rows = 0

    def add(self, block: Trajectory) -> None:
        """Compare the next rows of the test."""
        first = -self._rows % self._every
        seen = block.plant_position[first :: self._every]
        at = (self._rows + first) // self._every
        kept = slice(at, min(at + len(seen), len(self._ideal)))
        with np.errstate(over="ignore", invalid="ignore"):
            self._error[kept] = seen[: kept.stop - kept.start] - self._ideal[kept]
        if "E_fx" in block.energies:
            work = block.all_energies()["E_err"][first :: self._every]
            self._work[kept] = work[: kept.stop - kept.start]
        self._rows += len(block.t)

    def errors(self) -> dict[str, IdealError]:
        """Error of every dof of the plant."""
        return {dof: error_of(self._error[:, i], self._ideal[:, i]) for i, dof in enumerate(self._dofs)}

    def energy_per_cycle(self) -> float | None:
        """Mean work of the errors of the loop in each cycle of the first dof's motion, J; None: not known."""
        moved = self._error[:, 0] + self._ideal[:, 0]
        return energy_per_cycle(self.motion.t, self._work, moved)


class ErrorSoFar:
    """Error of every dof of the plant against the ideal system, gathered row by row.

    Parameters
    ----------
    dofs : int
        Of the plant.
    """

    def __init__(self, dofs: int) -> None:
        self._error, self._size, self._largest = np.zeros((3, dofs))

    def add(self, error: Floats, ideal: Floats) -> None:
        """Count rows (N, dofs): the error, m, and the ideal motion, m."""
        with np.errstate(over="ignore", invalid="ignore"):
            self._error += np.square(error).sum(axis=0)
            self._size += np.square(ideal).sum(axis=0)
        self._largest = np.maximum(self._largest, np.abs(error).max(axis=0, initial=0.0))

    def errors(self) -> list[IdealError]:
        """Of every dof; an error beside no motion at all has no nrmse."""
        with np.errstate(invalid="ignore", divide="ignore"):
            nrmse = np.where(self._size, np.sqrt(self._error / self._size), math.nan)
        return [IdealError(*pair) for pair in zip(nrmse.tolist(), self._largest.tolist(), strict=True)]


def error_of(error: Floats, ideal: Floats) -> IdealError:
    """Measures of an error (N,), m, beside the ideal motion (N,), m."""
    gathered = ErrorSoFar(1)
    gathered.add(error[:, None], ideal[:, None])
    return gathered.errors()[0]
