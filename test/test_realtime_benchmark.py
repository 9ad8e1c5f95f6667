"""The benchmark of the node graph: it runs, writes what it measured, and judges by what is asked."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from benchmarks.realtime.__main__ import main
from benchmarks.realtime.judge import judge_real_time, judge_simulated_time

from rthm_bringup.run.environment import Network

REAL = {
    "priority": True,
    "lost": 0,
    "excess": {"tau1": {"p99": 0.25e-3}},
    "excess_undisturbed": {"tau1": {"p99": 0.2e-3}},
    "energies": {"E_fx": {"run": -2.45, "exact": -2.4}},
}
SIMULATED = {"speed": [2.5, 2.1], "difference": 1e-12, "messages": 9, "identical": True}


def unmet(figures: dict) -> list[str]:
    judge = judge_real_time if "lost" in figures else judge_simulated_time
    return [line.what for line in judge(figures) if not line.met]


def test_figures_within_what_is_asked_are_met() -> None:
    assert unmet(REAL) == unmet(SIMULATED) == []


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"lost": 1}, "samples lost"),
        ({"excess": {"tau1": {"p99": 0.31e-3}}}, "excess of tau1, p99"),
        ({"priority": False, "excess": {"tau1": {"p99": 0.61e-3}}}, "excess of tau1, p99"),
        ({"energies": {"E_fx": {"run": -2.48, "exact": -2.4}}}, "E_fx"),
    ],
)
def test_a_run_in_real_time_that_falls_short_is_named(change: dict, named: str) -> None:
    assert unmet(REAL | change) == [named]


@pytest.mark.parametrize("change", [{"speed": [2.5, 1.9]}, {"difference": 2e-9}, {"identical": False}])
def test_runs_in_simulated_time_that_fall_short_are_named(change: dict) -> None:
    assert len(unmet(SIMULATED | change)) == 1


@pytest.mark.graph
@pytest.mark.usefixtures("nothing_left")
def test_the_benchmark_measures_both_ways_of_running(
    environment: dict[str, str], network: Network, tmp_path: Path, held_up: Callable[[float], float]
) -> None:
    main(["--out", str(tmp_path / "result"), "--duration", "1"])
    told = json.loads((tmp_path / "result.json").read_text())
    assert told["real"]["lost"] == 0 or held_up(60.0) > 0.1
    assert set(told["real"]["excess"]) == {"tau1", "tau2", "tau3", "tau4"}
    assert told["virtual"]["difference"] <= 1e-9
    assert told["virtual"]["identical"]
    assert [0.0 <= one["share"] < 1.0 for one in told["interruptions"]] == [True, True]
    assert "interrupted for at most" in (tmp_path / "result.md").read_text()
    assert told["virtual"]["messages"] > 1500
    page = (tmp_path / "result.md").read_text()
    assert "| speed |" in page
    assert "| excess of tau4, p99 |" in page
