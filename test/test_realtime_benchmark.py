"""The benchmark of the node graph: it runs, writes what it measured, and judges by what is asked."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from benchmarks.realtime.__main__ import main
from benchmarks.realtime.bare import CLOCKS, missed_ticks
from benchmarks.realtime.judge import judge_real_time, judge_simulated_time
from benchmarks.realtime.short_periods import judge_short_periods

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


def missed(bare: int, composed: int, apart: int = 99) -> dict:
    found = {"ticks": 60000, "bare": bare, "composed": composed, "apart": apart}
    found["cut_short"] = {"composed": 0, "apart": 2}
    return {"periods": {"0.001": found, "0.0005": found}}


def test_a_composed_loop_at_1_ms_misses_no_more_than_a_bare_one() -> None:
    assert [line.met for line in judge_short_periods(missed(5, 5))] == [True] * 4
    unmet = [line.what for line in judge_short_periods(missed(5, 6)) if not line.met]
    assert unmet == ["ticks missed at 1 ms, composed"]
    assert "ratio 1.20" in judge_short_periods(missed(5, 6))[0].value
    assert "ratio" not in judge_short_periods(missed(0, 0))[0].value


def test_runs_that_ended_early_are_told() -> None:
    composed, apart, *_ = judge_short_periods(missed(5, 5))
    assert "ended early" not in composed.value
    assert "2 of 3 runs ended early, with all their ticks missed" in apart.value


@pytest.mark.long
@pytest.mark.graph
@pytest.mark.usefixtures("nothing_left")
def test_a_bare_loop_counts_the_ticks_that_it_missed(environment: dict[str, str]) -> None:
    """Clocks faster than any interpreter miss all their ticks; slow ones hardly any."""
    impossible = missed_ticks(1e-6, 0.01)
    assert impossible > 0.9 * CLOCKS * 10_000
    assert missed_ticks(0.5, 1.0) <= CLOCKS


@pytest.mark.long
@pytest.mark.graph
@pytest.mark.usefixtures("nothing_left")
def test_the_benchmark_measures_both_ways_of_running(
    environment: dict[str, str], network: Network, tmp_path: Path, host_stalls: Callable[[float], float]
) -> None:
    main(["--out", str(tmp_path / "result"), "--duration", "1", "--only", "real", "--only", "virtual"])
    told = json.loads((tmp_path / "result.json").read_text())
    assert told["real"]["lost"] == 0 or host_stalls(60.0) > 0.1
    assert set(told["real"]["excess"]) == {"tau1", "tau2", "tau3", "tau4"}
    assert told["virtual"]["difference"] <= 1e-9
    assert told["virtual"]["identical"]
    assert [0.0 <= one["share"] < 1.0 for one in told["interruptions"]] == [True, True]
    assert "interrupted for at most" in (tmp_path / "result.md").read_text()
    assert told["virtual"]["messages"] > 1500
    page = (tmp_path / "result.md").read_text()
    assert "| speed |" in page
    assert "| excess of tau4, p99 |" in page
