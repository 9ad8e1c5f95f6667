"""Delays and clocks of a recording against the exact schedule."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.recording import read_recording
from rthm_analysis.recording.uses import tick_of_each
from rthm_analysis.timing import TimingResult, timing_of
from rthm_core.spec import apply, shipped_spec

from .conftest import START, Message, joint_state, mcap_file
from .loop import empty_states, links, stamps

SPEC = shipped_spec("paper")
MS = 1_000_000


def timing(folder: Path, messages: list[Message]) -> TimingResult:
    return timing_of(read_recording(mcap_file(folder / "x.mcap", messages)), SPEC)


def test_a_punctual_test_has_no_excess(tmp_path: Path) -> None:
    when = stamps(SPEC, 2.0)
    result = timing(tmp_path, empty_states(SPEC, when) + links(SPEC, when)).as_dict()
    for name in ("tau1", "tau2", "tau3", "tau4"):
        link = result["links"][name]
        assert link["excess"] == {"mean": 0.0, "p50": 0.0, "p99": 0.0, "max": 0.0}
        assert link["lost"] == 0
        assert link["late"] == 0
    for name, period in (("td1", 0.0012), ("td2", 0.012), ("td3", 0.004)):
        assert result["clocks"][name] == {
            "period_mean": pytest.approx(period),
            "period_p99": pytest.approx(period),
            "missed": 0,
        }
    assert "td4" not in result["clocks"]


def test_ages_are_those_of_the_holds_and_delays(tmp_path: Path) -> None:
    when = stamps(SPEC, 2.4)
    result = timing(tmp_path, empty_states(SPEC, when) + links(SPEC, when)).as_dict()
    ages = {name: link["age"] for name, link in result["links"].items()}
    assert ages["tau3"]["max"] == pytest.approx(0.012)
    assert ages["tau4"]["mean"] == pytest.approx(0.010)
    assert ages["tau1"]["mean"] == pytest.approx(0.0044, abs=2e-5)
    assert ages["tau2"]["max"] == pytest.approx(0.0084)


def test_late_uses_show_as_excess(tmp_path: Path) -> None:
    when = stamps(SPEC, 2.0)
    late = {"tau2": np.full(1000, 250_000), "tau4": np.full(1000, 2 * MS)}
    result = timing(tmp_path, empty_states(SPEC, when) + links(SPEC, when, late)).as_dict()
    assert result["links"]["tau2"]["excess"]["p50"] == pytest.approx(250e-6)
    assert result["links"]["tau4"]["excess"]["max"] == pytest.approx(2e-3)
    assert result["links"]["tau4"]["late"] == result["links"]["tau4"]["count"]
    assert result["links"]["tau1"]["excess"]["max"] == 0.0


def test_a_receiver_that_stood_still_and_caught_up_is_late_and_not_early(tmp_path: Path) -> None:
    when = stamps(SPEC, 1.0)
    stall = np.zeros(1000, dtype=np.int64)
    stall[50:53] = [10 * MS, 7 * MS, 4 * MS]
    result = timing(tmp_path, empty_states(SPEC, when) + links(SPEC, when, {"tau1": stall}))
    excess = result.links["tau1"].excess
    assert excess.min() == 0.0
    np.testing.assert_allclose(excess[50:53], [10e-3, 7e-3, 4e-3], atol=1e-9)
    assert result.clocks["td3"].missed == 2


def test_lost_samples_are_counted(tmp_path: Path) -> None:
    spec = apply(
        SPEC, {"effects": ["gone"], "gone.block": "link.tau3", "gone.kind": "loss", "gone.fraction": 0.2}
    )
    when = stamps(spec, 4.0)
    messages = empty_states(SPEC, when) + links(spec, when)
    result = timing(tmp_path, messages)
    ticks = when.tick[when.tick <= when.reference_used[-1]]
    assert result.links["tau3"].lost == ticks.size - when.reference_used.size > 20


def test_missing_plant_samples_are_missed_ticks(tmp_path: Path) -> None:
    when = stamps(SPEC, 1.0)
    gone = {START + 100 * 1_200_000, START + 101 * 1_200_000}
    messages = [m for m in empty_states(SPEC, when) if not (m[0] == "/rthm/plant/state" and m[1] in gone)]
    result = timing(tmp_path, messages + links(SPEC, when))
    assert result.clocks["td1"].missed == 2
    assert result.links["tau1"].lost == 2


def test_links_that_are_not_recorded_are_derived_and_said(tmp_path: Path) -> None:
    when = stamps(SPEC, 1.0)
    result = timing(tmp_path, empty_states(SPEC, when))
    exact = timing(tmp_path, empty_states(SPEC, when) + links(SPEC, when))
    for name in ("tau1", "tau2", "tau3", "tau4"):
        assert any(f"links/{name}" in note for note in result.notes)
        assert result.links[name].age.mean() == pytest.approx(exact.links[name].age.mean(), abs=2e-4)


def test_a_plant_alone_has_one_clock(tmp_path: Path) -> None:
    messages = [joint_state("/plant/state", START + k * 1_000_000, ("x1",), (0.0,)) for k in range(100)]
    recording = read_recording(mcap_file(tmp_path / "x.mcap", messages))
    result = timing_of(recording, None).as_dict()
    assert result["links"] == {}
    assert result["clocks"]["td1"]["period_mean"] == pytest.approx(1e-3)


def test_uses_of_a_receiver_that_catches_up_belong_to_the_ticks_that_it_missed() -> None:
    ticks = np.arange(10) * 10
    uses = np.array([1, 11, 55, 56, 57, 62, 63, 71, 81])
    assert tick_of_each(uses, ticks, 10).tolist() == [0, 1, 2, 3, 4, 5, 6, 7, 8]


def test_a_repeated_use_moves_no_other() -> None:
    ticks = np.arange(6) * 10
    assert tick_of_each(np.array([1, 11, 21, 25, 31, 41]), ticks, 10).tolist() == [0, 1, -1, 2, 3, 4]


def test_a_use_of_an_unknown_tick_moves_no_other() -> None:
    ticks = np.array([0, 10, 20, 40])
    assert tick_of_each(np.array([-3, 1, 11, 21, 31, 41, 51]), ticks, 10).tolist() == [-1, 0, 1, 2, -1, 3, -1]
