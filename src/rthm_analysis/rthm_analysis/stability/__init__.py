"""Exact stability of sampled loops (``docs/theory.md``)."""

from rthm_analysis.stability.analysis import slowest, spectral_radius, stability
from rthm_analysis.stability.result import Stability

__all__ = ["Stability", "slowest", "spectral_radius", "stability"]
