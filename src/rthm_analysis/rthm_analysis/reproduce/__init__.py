"""Every figure and table of the paper from the project's own code."""

from rthm_analysis.reproduce.reproduce import Reproduction, reproduce

__all__ = ["Reproduction", "reproduce"]
