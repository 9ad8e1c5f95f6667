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
