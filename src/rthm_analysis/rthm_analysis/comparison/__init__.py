"""Tests beside each other: recordings, trajectories and simulations on one time, their differences, and what
the field measures of them.

`Motion` is what a source says; `measures` are definitions; `Comparison` is the answer.
"""

from rthm_analysis.comparison.comparison import Comparison, compare
from rthm_analysis.comparison.difference import Difference
from rthm_analysis.comparison.motion import Motion, Signal
from rthm_analysis.comparison.sources import motions_at

__all__ = ["Comparison", "Difference", "Motion", "Signal", "compare", "motions_at"]
