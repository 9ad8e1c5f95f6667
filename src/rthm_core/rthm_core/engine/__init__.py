"""The exact engine: the schedule executed over the three sides."""

from rthm_core.engine.simulate import Trajectory, simulate

__all__ = ["Trajectory", "simulate"]
