"""The page about a recorded test: one HTML file that needs nothing else."""

from rthm_analysis.report.page import write_report
from rthm_analysis.report.verdict import Fact, verdict

__all__ = ["Fact", "verdict", "write_report"]
