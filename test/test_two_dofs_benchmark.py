"""The concealed cases of two dofs are the contract's physics: with the truth told, nothing is missing."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from benchmarks.two_dofs.__main__ import is_found, page, plan
from benchmarks.two_dofs.case import Case, make_case

from rthm_analysis.diagnosis import diagnose
from rthm_analysis.recording import read_recording
from rthm_core.spec import Spec, apply, read_spec


def told(case: Case) -> Spec:
    """The nominal spec with what was concealed."""
    place = {"dof": "x1", "relative_to": "x2"} if case.place == "between" else {"dof": case.place}
    section = {"block": "plant", "kind": case.kind, **place, **case.parameters}
    return apply(read_spec(case.spec), {"effects": ["truth"], "truth": section})


@pytest.mark.parametrize(
    ("seed", "place", "motors"), [(3, "between", True), pytest.param(7, "x2", False, marks=pytest.mark.long)]
)
def test_with_the_truth_told_nothing_is_missing(seed: int, place: str, motors: bool, tmp_path: Path) -> None:
    case = make_case(seed, place, motors=motors, folder=tmp_path)
    assert case.kind not in case.spec.read_text() and case.visibility > 3.0
    assert "effects" not in yaml.safe_load(case.spec.read_text())["/**"]["ros__parameters"]
    assert diagnose(read_recording(case.bag), told(case)).verdict == "match"


def test_a_plan_has_every_place_equally_often_and_the_page_counts_them() -> None:
    items = plan(1, each=2, clean=1)
    places = [(one.place, one.motors) for one in items]
    assert len(items) == 14 and all(places.count(one) == (2 if one[0] else 1) for one in places)
    rows = [
        {"place": one.place, "motors": one.motors, "kind": "clearance", "named": [["clearance", "x1"]]}
        for one in items
    ]
    assert [is_found(row) for row in rows] == [one.place == "x1" for one in items]
    text = page({"date": "a day", "machine": "one", "master": 1}, rows)
    assert "| plant alone | x1 | 2/2 |" in text and "4/12 (33 %" in text
