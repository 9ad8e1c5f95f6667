"""Importing the core is cheap: what is heavy is imported where it is needed."""

from __future__ import annotations

import subprocess
import sys

import pytest

CPU = "import time; before = time.process_time(); import {module}; print(time.process_time() - before)"
HEAVY = "import sys, {module}; print(*(m for m in {heavy} if m in sys.modules))"


def run(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout


def cpu_of_import(module: str) -> float:
    """Least CPU seconds of several fresh interpreters: other work on the machine only ever adds."""
    return min(float(run(CPU.format(module=module))) for _ in range(7))


def test_importing_the_core_costs_at_most_twice_importing_numpy() -> None:
    assert cpu_of_import("rthm_core") <= 2 * cpu_of_import("numpy")


@pytest.mark.parametrize("module", ["rthm", "rthm_core", "rthm_analysis", "rthm_bringup"])
def test_importing_a_package_compiles_nothing_and_draws_nothing(module: str) -> None:
    heavy = ("bokeh", "matplotlib", "numba", "pydantic", "rclpy", "scipy.optimize", "scipy.signal")
    assert run(HEAVY.format(module=module, heavy=heavy)).split() == []


LATER = """
import sys
from rthm_analysis.outcome.margin import margin_of
from rthm_core.engine import simulate
from rthm_core.spec import shipped_spec

paper = shipped_spec("paper")
simulate(paper, 1.0)
margin_of(paper)
print(*(m for m in ("numba.np.arrayobj", "numba.cpython.unicode", "scipy.linalg") if m in sys.modules))
"""


def test_a_later_simulation_with_its_margin_imports_nothing_that_only_compiling_needs() -> None:
    run(LATER)  # which compiles what is not there
    assert run(LATER).split() == []
