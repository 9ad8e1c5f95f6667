"""The exact engine: the schedule executed over the three sides."""

from rthm_core.engine.ensemble import Ensemble, simulate_many
from rthm_core.engine.simulate import Trajectory, simulate, simulate_blocks

__all__ = ["Ensemble", "Trajectory", "simulate", "simulate_blocks", "simulate_many"]
