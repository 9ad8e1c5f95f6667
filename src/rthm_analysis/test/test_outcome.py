"""The verdict on a test: stability and margin, error against the ideal system, late samples, limits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.energy import energy_of
from rthm_analysis.lifted import radii
from rthm_analysis.lifted.lifted import Lifted
from rthm_analysis.outcome import (
    IdealComparison,
    Lateness,
    Margin,
    Outcome,
    ideal,
    margin_of,
    margin_or_why,
    outcome_of,
)
from rthm_analysis.outcome.cycles import energy_per_cycle
from rthm_analysis.outcome.ideal import error_of
from rthm_analysis.outcome.outcome import error_words
from rthm_analysis.recording import read_recording
from rthm_analysis.report.verdict import verdict
from rthm_analysis.stability import stability
from rthm_analysis.stability.edges import first_lost
from rthm_analysis.stability.search import scan
from rthm_analysis.timing import timing_of
from rthm_core.engine import simulate
from rthm_core.engine.simulate import simulate_blocks
from rthm_core.spec import LimitsSpec, apply, shipped_spec

from .conftest import mcap_file
from .loop import recorded

PAPER = shipped_spec("paper")
UNSTABLE = apply(PAPER, {"timing.tau2": 0.09})


def test_the_margin_is_that_of_the_whole_analysis_of_stability() -> None:
    margin, whole = margin_of(PAPER), stability(PAPER)
    assert margin.stable and margin.spectral_radius == whole.spectral_radius
    assert margin.scale == pytest.approx(whole.limits["scale"].critical_scale, abs=1e-6)
    assert margin.delays["tau2"][1] == pytest.approx(whole.limits["tau2"].critical_value, abs=1e-7)
    assert margin.nearest is not None and margin.nearest[0] == "tau3"
    assert margin.doubling_time is None


def test_an_unstable_loop_says_how_fast_it_grows_and_which_delay_makes_it_stable() -> None:
    margin = margin_of(UNSTABLE)
    assert not margin.stable and margin.doubling_time is not None
    motion = np.abs(simulate(UNSTABLE, 400.0, 0.05, energies=False).plant_position[:, 0])
    early, late = motion[: motion.size // 2].max(), motion[motion.size // 2 :].max()
    assert late / early == pytest.approx(2.0 ** (200.0 / margin.doubling_time), rel=0.1)
    assert margin.nearest is not None and margin.nearest[0] == "tau2"
    assert margin_of(apply(UNSTABLE, {"timing.tau2": 0.99 * margin.nearest[2]})).stable
    assert margin.words.startswith("Unstable: a small motion doubles every 21.3 s. It is stable below 0.713")


@pytest.mark.parametrize(
    ("scale", "tau3", "words"),
    [
        (21.17, 0.08162, "all periods and delays could grow 21.2-fold, or tau3 alone from 12 to 81.6 ms."),
        (21.17, None, "all periods and delays could grow 21.2-fold."),
        (9.0, 0.005, "all periods and delays could grow 9-fold, or tau3 alone could shrink from 12 to 5 ms."),
        (0.713, None, "all periods and delays could shrink to 0.713 of their values."),
        (None, 0.01201, "tau3 alone could grow from 12 to 12.01 ms."),
    ],
)
def test_a_margin_says_what_could_change_and_how_far(scale: float, tau3: float, words: str) -> None:
    assert Margin(0.9, 0.012, scale, {"tau3": (0.012, tau3)}).words == f"Stable; {words}"


def test_a_loop_without_an_edge_says_how_far_it_was_searched() -> None:
    margin = Margin(0.9, 0.012, None, {"tau3": (0.012, None)})
    assert margin.words == "Stable, even with any one delay 10 times as long."


def test_energy_per_cycle_is_that_of_a_damper_that_moves_to_and_fro() -> None:
    t = np.linspace(0.0, 20.0, 8001)
    omega, damping, amplitude = 2.0 * np.pi * 1.37, 0.3, 0.05
    speed = amplitude * omega * np.cos(omega * t)
    work = -np.concatenate([[0.0], np.cumsum(damping * speed[1:] ** 2) * t[1]])
    expected = -np.pi * damping * omega * amplitude**2
    found = energy_per_cycle(t, work, amplitude * np.sin(omega * t))
    assert found == pytest.approx(expected, rel=0.01)
    assert energy_per_cycle(t[:200], work[:200], np.sin(omega * t[:200])) is None


def test_a_recording_and_a_simulation_tell_the_energy_per_cycle(tmp_path: Path) -> None:
    recording = read_recording(mcap_file(tmp_path / "loop.mcap", recorded(PAPER, 10.0)))
    energy = energy_of(recording, PAPER)
    found = outcome_of(recording, None, energy)
    assert found is not None and found.energy_per_cycle is not None
    assert found.as_dict()["energy_per_cycle"] == found.energy_per_cycle < 0.0
    assert "Energy taken out per cycle" in {
        fact.label for fact in verdict(energy, timing_of(recording, PAPER), found)
    }
    assert Outcome("no loop").as_dict()["energy_per_cycle"] is None
    beside = IdealComparison(PAPER, 10.0)
    for block in simulate_blocks(PAPER, 10.0):
        beside.add(block)
    assert beside.energy_per_cycle() == pytest.approx(found.energy_per_cycle, rel=0.02)
    assert any("J out of each cycle" in line for line in found.lines())


def test_a_loop_whose_stability_is_not_known_says_why() -> None:
    said = Outcome(margin_or_why(shipped_spec("decay")))
    assert said.stability.startswith("Stability not determined: ")
    assert said.as_dict()["stable"] is None


@pytest.mark.parametrize(("rows", "near"), [(ideal.INSTANTS_COMPARED, 1e-9), (1000, 5e-3)])
def test_the_error_of_the_paper_is_the_one_worked_out_by_hand(
    rows: int, near: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ideal, "INSTANTS_COMPARED", rows)
    beside = IdealComparison(PAPER, 20.0)
    for block in simulate_blocks(PAPER, 20.0):
        beside.add(block)
    test, model = simulate(PAPER, 20.0), simulate(PAPER, 20.0, system="ideal")
    error = test.plant_position - model.plant_position
    by_hand = np.sqrt(np.mean(error**2) / np.mean(model.plant_position**2))
    assert by_hand == pytest.approx(0.4475, abs=1e-4)
    assert beside.errors()["x1"].nrmse == pytest.approx(by_hand, rel=near)
    assert beside.errors()["x1"].largest == pytest.approx(np.abs(error).max(), rel=near)


def test_words_of_an_error_say_what_there_is_to_say() -> None:
    assert "44.8 %" in error_words("x1", error_of(np.array([0.448]), np.array([1.0])))
    assert "does not move" in error_words("x1", error_of(np.array([0.1]), np.array([0.0])))
    assert "diverges" in error_words("x1", error_of(np.array([np.inf]), np.array([1.0])))


def test_a_recorded_test_is_judged_by_its_own_motion_delays_and_limits(tmp_path: Path) -> None:
    limits = LimitsSpec(command=10.0, position=0.4, velocity=100.0)
    spec = PAPER.model_copy(update={"limits": limits})
    recording = read_recording(mcap_file(tmp_path / "loop.mcap", recorded(spec, 3.0)))
    model = simulate(spec, recording.duration, 0.0012, "ideal", energies=False)
    found = outcome_of(recording, model)
    assert found is not None and found.lateness is not None
    assert found.lateness.ok and found.lateness.error < 1e-9
    true = simulate(spec, recording.duration, 0.0012, energies=False).plant_position
    rows = min(len(true), len(model.t))
    by_hand = error_of(true[:rows, 0] - model.plant_position[:rows, 0], model.plant_position[:rows, 0])
    assert found.error["x1"].nrmse == pytest.approx(by_hand.nrmse, rel=0.01)
    assert found.limits_touched == ("position",)
    facts = verdict(None, timing_of(recording, recording.spec), found)
    assert [fact.label for fact in facts[:2]] == ["Loop", "x1 against the ideal system"]


def test_late_samples_that_move_the_test_are_told() -> None:
    assert (
        Lateness(0.02).words == "Timing mattered: late samples changed the motion by 2 % (of the ideal rms)."
    )
    assert not Lateness(0.02).ok and Lateness(0.002).ok


def test_a_margin_looks_at_few_loops_and_compiles_nothing_for_many_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looked, monodromy = [], Lifted.monodromy
    monkeypatch.setattr(Lifted, "monodromy", lambda one: looked.append(one) or monodromy(one))
    monkeypatch.setattr(radii, "moduli", None)
    assert margin_of(PAPER).scale == pytest.approx(21.1688, abs=1e-3)
    assert len(looked) < 400  # 584 where every search goes on beyond the edge that it has found


@pytest.mark.parametrize("points", [np.linspace(0.0, 1.0, 3), np.linspace(0.0, 1.0, 60)])
def test_the_first_loss_of_stability_is_that_of_the_whole_scan(points: np.ndarray) -> None:
    def rates(x: np.ndarray) -> np.ndarray:
        return np.stack([0.3 - np.cos(12.0 * x) ** 2, np.full(x.size, -1.0)], axis=1)

    def low(x: np.ndarray) -> np.ndarray:
        return rates(x) - 1.0

    assert first_lost(rates, points, 1e-9) == pytest.approx(
        scan(rates, points, 1e-9).first_lost(0.0), abs=1e-9
    )
    assert first_lost(rates, points + 0.1, 1e-9) == 0.1
    assert first_lost(low, points, 1e-9) is None
