"""What a dashboard costs: the page says so where it costs something, and one run of each is measured."""

from __future__ import annotations

from typing import Any

import pytest
from benchmarks.watched.__main__ import measured
from benchmarks.watched.table import page


def runs(watched: bool, ages: list[float], missed: list[int]) -> list[dict[str, Any]]:
    return [
        {"watched": watched, "excess": {"tau1": age}, "missed": count, "lost": 0, "cost": 0.08}
        for age, count in zip(ages, missed, strict=True)
    ]


@pytest.mark.parametrize(
    ("ages", "missed", "answer"),
    [
        ([1e-4, 2e-4, 9e-3], [0, 0, 40], "| yes | yes | yes |"),
        ([4e-4, 4e-4, 1e-4], [0, 0, 0], "| **no** | yes | yes |"),
        ([1e-4, 1e-4, 1e-4], [2, 3, 2], "| yes | **no** | yes |"),
    ],
)
def test_a_dashboard_that_costs_something_is_told(ages: list[float], missed: list[int], answer: str) -> None:
    made = [*runs(False, [1e-4, 2e-4, 1e-4], [0, 1, 0]), *runs(True, ages, missed)]
    table = {"date": "2026-11-27", "machine": "a host", "spec": "paper", "duration": 10.0, "runs": made}
    assert page(table).count(answer) == 1
    assert f"{1e6 * max(ages):.0f} us" in page(table)


def test_the_ranks_tell_what_largest_values_do_not() -> None:
    alone, later = [1e-4 + 1e-6 * k for k in range(8)], [1e-4 + 1e-6 * (k + 8) for k in range(8)]
    header = {"date": "2026-11-27", "machine": "a host", "spec": "paper", "duration": 10.0}
    same, worse = (
        page(header | {"runs": [*runs(False, alone, [0] * 8), *runs(True, ages, [0] * 8)]})
        for ages in (alone, later)
    )
    assert "| 0.52 | 1.00 | 1.00 |" in same
    assert "| 0.00 | 1.00 | 1.00 |" in worse


@pytest.mark.long
@pytest.mark.graph
@pytest.mark.usefixtures("nothing_left")
def test_one_run_of_each_is_measured(environment: dict[str, str]) -> None:
    alone, watched = measured(1, "paper", 5.0, int(environment["ROS_DOMAIN_ID"]))
    assert not alone["watched"] and watched["watched"]
    assert set(alone["excess"]) == {"tau1", "tau2", "tau3", "tau4"}
    assert 0.0 < watched["cost"] < 1.0
