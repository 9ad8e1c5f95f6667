"""What is in a folder of runs: one line for each, from what the runs left there."""

from rthm_analysis.runs.index import ORDERS, Run, runs_in, sorted_runs

__all__ = ["ORDERS", "Run", "runs_in", "sorted_runs"]
