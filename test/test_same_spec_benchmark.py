"""Simulations that are diagnosed with their own spec: how they are drawn, and that nothing is missing."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from benchmarks.same_spec.__main__ import markdown
from benchmarks.same_spec.draw import BOUNDED, DURATION, SIZES, Draw, draws, spec_of
from benchmarks.same_spec.record import bag_of

from rthm_analysis.diagnosis import diagnose
from rthm_analysis.recording import read_recording
from rthm_core.engine import simulate
from rthm_core.spec import write_spec

RUBS = Draw(0, 1778204604, "plant", "coulomb_friction", 0.05, 0.001, velocity=False, in_loop=False)
STIFFENS = replace(RUBS, seed=761389284, kind="cubic_stiffness", size=1.5)
PLAYS = replace(RUBS, seed=131972117, kind="clearance", size=1.5, td1=0.005)
PULLS = replace(RUBS, seed=981591350, kind="quadratic_stiffness", size=1.5, td1=0.005, in_loop=True)
SLACKENS = replace(PULLS, block="wire", kind="slack")


@pytest.mark.parametrize(
    "draw", [pytest.param(RUBS, marks=pytest.mark.long), STIFFENS, PLAYS], ids=lambda one: one.kind
)
def test_nothing_is_missing_where_no_velocity_tells_how_the_motion_began(draw: Draw, tmp_path: Path) -> None:
    spec, path = spec_of(draw), tmp_path / "spec.yaml"
    path.write_text(write_spec(spec))
    assert diagnose(read_recording(bag_of(draw, spec, path)), spec).verdict == "match"


@pytest.mark.parametrize(
    "draw",
    [STIFFENS, *(pytest.param(one, marks=pytest.mark.long) for one in (PULLS, SLACKENS))],
    ids=lambda one: one.kind,
)
def test_what_dominates_lets_the_motion_be_bounded(draw: Draw) -> None:
    spec = spec_of(draw)
    motion = simulate(spec, DURATION, 0.01, energies=False).plant_position
    assert spec.effects[0].kind == draw.kind and np.abs(motion).max() < BOUNDED


def test_a_plan_has_all_sizes_periods_and_channels_alone_and_in_the_loop() -> None:
    plan = draws(200, 1)
    assert {one.size for one in plan} == set(SIZES) and {one.td1 for one in plan} == {0.001, 0.005}
    assert {(one.velocity, one.in_loop) for one in plan} == {
        (a, b) for a in (True, False) for b in (True, False)
    }
    assert {one.block for one in plan if one.in_loop} == {"plant", "wire"}


def test_the_page_counts_matches_and_names_the_others() -> None:
    rows = [RUBS.row() | {"verdict": "match"}, PLAYS.row() | {"verdict": "unexplained", "named": []}]
    page = markdown({"date": "a day", "machine": "one", "master": 1}, rows)
    assert "1 of 2 are a match; 0 are called explained" in page
    assert "| plant clearance 1.5, alone, x, 5 ms | 131972117 | unexplained |" in page
