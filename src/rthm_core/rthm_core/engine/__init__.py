"""The exact engine: the schedule executed over the three sides."""

from typing import TYPE_CHECKING, Any

from rthm_core.engine.sensitivities import Sensitivities, sensitivities
from rthm_core.engine.simulate import simulate, simulate_blocks
from rthm_core.engine.trajectory import Trajectory

if TYPE_CHECKING:
    from rthm_core.engine.many.ensemble import Ensemble, simulate_many

__all__ = [
    "Ensemble",
    "Sensitivities",
    "Trajectory",
    "sensitivities",
    "simulate",
    "simulate_blocks",
    "simulate_many",
]


def __getattr__(name: str) -> Any:
    """What simulates many loops is imported when it is first used: one loop alone need not wait for it."""
    if name not in ("Ensemble", "simulate_many"):
        raise AttributeError(f"{__name__} has no {name!r}, only {', '.join(__all__)}.")
    from rthm_core.engine.many import ensemble

    return getattr(ensemble, name)
