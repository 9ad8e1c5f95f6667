"""Exact stability of sampled loops (``docs/theory.md``)."""

from rthm_analysis.stability.analysis import spectral_radius, stability
from rthm_analysis.stability.result import Stability

__all__ = ["Stability", "spectral_radius", "stability"]
