"""The exact engine: the schedule executed over the three sides."""

from rthm_core.engine.many.ensemble import Ensemble, simulate_many
from rthm_core.engine.sensitivities import Sensitivities, sensitivities
from rthm_core.engine.simulate import simulate, simulate_blocks
from rthm_core.engine.trajectory import Trajectory

__all__ = [
    "Ensemble",
    "Sensitivities",
    "Trajectory",
    "sensitivities",
    "simulate",
    "simulate_blocks",
    "simulate_many",
]
