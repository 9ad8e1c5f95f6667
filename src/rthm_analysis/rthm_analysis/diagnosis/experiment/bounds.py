"""How large a planned test may be: the limits of the spec, and about the range that has been tried."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.experiment import LIMIT_SHARE, UNLIMITED_RANGE_RATIO
from rthm_analysis.diagnosis.experiment.predicting import Predicted
from rthm_analysis.diagnosis.experiment.trials import Trial
from rthm_core.loads import load

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


LIMITED = {
    "command": "command",
    "rate": "rate",
    "force": "force",
    "measured_force": "force",
    "position": "position",
    "velocity": "velocity",
}
"""Family of signals that each entry of ``limits`` is about."""

TRIED = ("position", "force", "command")
"""Families that stay near the range of the present test where the spec has no limit for them."""


class Bounds(NamedTuple):
    """Largest sizes, by family of signals, and of a known load, N (None: what the motion allows)."""

    signals: dict[str, float]
    load: float | None

    def used(self, predicted: Predicted) -> float:
        """Largest part of a bound that a prediction reaches; above 1 it is too much, and NaN is infinite."""
        parts = [predicted.largest(family) / most for family, most in self.signals.items()]
        worst = max(parts, default=0.0)
        return worst if np.isfinite(parts).all() else np.inf


def bounds_of(nominal: Spec, present: Trial, predicted: Predicted) -> Bounds:
    """Bounds of planned tests, from the spec's limits and the present test as it is predicted."""
    limited: dict[str, float] = {}
    for name, value in nominal.limits.items() if nominal.limits else ():
        if name in LIMITED and isinstance(value, float):
            limited[LIMITED[name]] = min(LIMIT_SHARE * value, limited.get(LIMITED[name], np.inf))
    signals = {family: UNLIMITED_RANGE_RATIO * predicted.largest(family) for family in TRIED} | limited
    load = UNLIMITED_RANGE_RATIO * _largest_load(present, predicted)
    if nominal.limits is not None and nominal.limits.force is not None and not nominal.is_loop:
        load = LIMIT_SHARE * nominal.limits.force
    return Bounds({family: most for family, most in signals.items() if most > 0.0}, load or None)


def _largest_load(present: Trial, predicted: Predicted) -> float:
    """Largest known force of the present test, N."""
    time = predicted.time
    forces: list[Floats] = [load(section).force(time) for section in present.loads.values()]
    if present.recorded is not None:
        forces.append(present.recorded[1])
    return max((float(np.nanmax(np.abs(one))) for one in forces), default=0.0)
