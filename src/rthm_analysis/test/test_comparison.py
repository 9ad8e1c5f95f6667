"""Tests beside each other: aligned, named alike, and told apart by what is different in them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.comparison import Motion, Signal, compare, motions_at
from rthm_analysis.comparison.delays import delays_of
from rthm_analysis.comparison.motion import paired
from rthm_analysis.comparison.recorded import motion_of_recording
from rthm_analysis.comparison.rows import difference_rows
from rthm_analysis.comparison.simulated import motion_of_columns, motion_of_spec, names_of
from rthm_analysis.energy import energy_of
from rthm_analysis.recording import Recording, read_recording
from rthm_analysis.report.comparison import comparison_page
from rthm_core.engine import simulate
from rthm_core.errors import InputError
from rthm_core.spec import Spec, apply, shipped_spec, shipped_text, write_spec

from .conftest import mcap_file
from .loop import recorded

PAPER = shipped_spec("paper")
POLED = apply(PAPER, {"actuator.motor_poles": [400.0, 2000.0]})
SECONDS = 3.0


def with_motor(one: Recording, spec: Spec) -> Recording:
    """The recording with the position of its motor, which follows from the force in its wire."""
    plant = one.plant
    position = plant.position.copy()
    dof, motor = plant.names.index("x1"), plant.names.index("a1")
    position[:, motor] = position[:, dof] + plant.effort[:, motor] / spec.k_tot[0]
    return replace(one, tables=one.tables | {"plant/state": replace(plant, position=position)})


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run") / "bag"
    folder.mkdir()
    return mcap_file(folder / "loop.mcap", recorded(PAPER, SECONDS)).parent


def ramp(name: str, times_ns: list[int], *, held: bool = False) -> Signal:
    return Signal(name, "m", np.array(times_ns), np.array(times_ns, dtype=float), held)


def test_nothing_is_invented_outside_what_both_know_or_in_gaps() -> None:
    one, other = ramp("x1", [*range(0, 100, 10)]), ramp("x1", [*range(35, 75, 5)])
    pair = paired(one, other)
    assert (pair.time * 1e9).round().tolist() == [40, 50, 60, 70]
    assert pair.one.tolist() == pair.other.tolist() == [40.0, 50.0, 60.0, 70.0]
    gap = ramp("x1", [*range(0, 50, 10), 500, 510])
    assert np.isnan(gap.at(np.array([100, 499]))).all()
    assert gap.at(np.array([40, 505])).tolist() == [40.0, 505.0]


def test_a_held_signal_is_a_step_and_is_read_where_the_other_is_sampled() -> None:
    held = ramp("a1.command", [0, 40, 80], held=True)
    assert held.at(np.array([0, 39, 40, 119])).tolist() == [0.0, 0.0, 40.0, 80.0]
    assert np.isnan(held.at(np.array([121]))).all()
    pair = paired(held, ramp("a1.motor", [*range(0, 100, 12)]))
    assert pair.one.tolist() == [0.0, 0.0, 0.0, 0.0, 40.0, 40.0, 40.0, 80.0, 80.0]


def test_a_spec_beside_itself_differs_by_nothing() -> None:
    found = compare(motions_at(["paper", "paper"], 2.0), 0.0)
    assert found.within and found.words.startswith("within 0 %: differs by 0 % at most")
    assert all(one.largest == 0.0 for one in found.against[0].differences.values())
    assert found.against[0].offset.value == 0.0


def test_a_recording_differs_from_its_simulation_by_rounding_alone(bag: Path) -> None:
    found = compare(motions_at([str(bag.parent), "paper"]))
    (one,) = found.against
    assert set(one.judged) == {"x1", "x2", "a1.force", "a1.reference"}
    assert max(each.nrmse for each in one.judged.values()) < 1e-9
    assert one.missing == ("a1.command", "a1.motor")
    balance = found.told[0].balance
    assert balance.at_end["E_err"] == pytest.approx(found.told[1].balance.at_end["E_err"], abs=1e-3)


def test_the_error_of_the_paper_is_that_of_its_verdict() -> None:
    columns = {
        key: one for key, one in vars(simulate(PAPER, 20.0, system="ideal")).items() if key != "energies"
    }
    ideal = motion_of_columns("ideal", "trajectory", columns, names_of(PAPER))
    found = compare([ideal, motion_of_spec("paper", PAPER, 20.0)], 0.02)
    assert found.against[0].differences["x1"].nrmse == pytest.approx(0.4475, abs=1e-4)
    assert found.within is False
    assert found.words.startswith("differs by") and "more than 2 %" in found.words


@pytest.mark.parametrize("late", [0.0037, 0.0001, 0.0412])
def test_an_injected_offset_between_two_tests_is_measured_within_50_us(late: float) -> None:
    whole = simulate(PAPER, 10.0 + late, 0.0001, energies=False).plant_position[:, 0]
    first = round(late / 0.0001)
    t = np.arange(0.0, 10.0, 0.001)
    now, then = whole[first:][: 10 * t.size : 10], whole[: 10 * t.size : 10]
    motions = [
        motion_of_columns(name, "trajectory", {"t": t, "plant_position": values[:, None]}, names_of(PAPER))
        for name, values in (("now", now), ("late", then))
    ]
    offset = compare(motions).against[0].offset
    assert offset.value == pytest.approx(late, abs=50e-6)


def test_injected_delays_of_links_are_measured_within_50_us(tmp_path: Path) -> None:
    injected = {"timing.tau1": 0.006, "timing.tau3": 0.0151, "timing.tau4": 0.0123}
    spec = apply(PAPER, injected)
    one = read_recording(mcap_file(tmp_path / "a.mcap", recorded(spec, SECONDS)))
    found = delays_of(motion_of_recording("a", one))
    assert found["tau3"].value == pytest.approx(0.0151, abs=50e-6)
    assert found["tau4"].value == pytest.approx(0.0123, abs=50e-6)
    # what is used every 4 ms, of samples every 1.2 ms, is older than tau1 by 0, 0.4 and 0.8 ms in turn
    assert found["tau1"].value == pytest.approx(0.0064, abs=50e-6)
    scheduled = delays_of(motion_of_spec("spec", spec, SECONDS))
    assert all(scheduled[name].value == pytest.approx(found[name].value, abs=50e-6) for name in scheduled)


@pytest.mark.parametrize("tau4", [0.010, 0.0137, 0.0222])
def test_the_delay_of_command_to_motion_is_measured_within_50_us(tau4: float, tmp_path: Path) -> None:
    spec = apply(POLED, {"timing.tau4": tau4})
    one = with_motor(read_recording(mcap_file(tmp_path / "a.mcap", recorded(spec, SECONDS))), spec)
    found = delays_of(motion_of_recording("a", one))["a1.command to a1.motor"]
    assert found.value == pytest.approx(tau4 + 1.0 / 400.0 + 1.0 / 2000.0, abs=50e-6)
    assert found.std < 50e-6


def test_a_motor_that_follows_at_once_is_late_by_tau4(bag: Path) -> None:
    one = with_motor(read_recording(bag), PAPER)
    motion = motion_of_recording("a", one)
    found = compare([motion, motion])
    assert found.told[0].delays["a1.command to a1.motor"].value == pytest.approx(0.010, abs=50e-6)
    follows = {each.got: each for each in found.told[0].trackings}
    assert follows["a1.motor"].delay == pytest.approx(0.010, abs=5e-4)
    assert follows["a1.motor"].evaluation.amplitude == pytest.approx(1.0, abs=0.02)
    assert follows["a1.motor"].indicator > 0.0


def test_equivalent_damping_is_that_of_the_books(bag: Path) -> None:
    recording = read_recording(bag)
    balance = energy_of(recording, recording.spec)
    found = compare(motions_at([str(bag), "paper"])).told
    assert found[0].balance.damping["E_err"] == pytest.approx(balance.equivalent_damping, rel=1e-9)
    assert found[1].balance.damping["E_err"] == pytest.approx(balance.equivalent_damping, rel=2e-3)
    assert found[0].balance.error == pytest.approx(balance.error[-1] / balance.total.max(), rel=1e-9)


def test_a_trajectory_takes_its_names_from_the_first_source_with_a_spec(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", t=[0.0, 0.1, 0.2], plant_position=[[0.5], [0.4], [0.3]])
    (tmp_path / "mine.yaml").write_text(shipped_text("paper").replace('"x1"', '"table"'))
    first, second = motions_at([str(tmp_path / "a.npz"), str(tmp_path / "mine.yaml")])
    assert first.dofs == ("table",) and second.dofs == ("table", "x2")
    alone, again = motions_at([str(tmp_path / "a.npz")] * 2)
    assert alone.dofs == again.dofs == ("x1",)


def test_a_recording_without_a_spec_takes_its_names_from_the_others(plant_bag: Callable[[str], Path]) -> None:
    bag = str(plant_bag("mcap"))
    recorded_alone, _ = motions_at([bag, "paper"])
    assert recorded_alone.dofs == ("x1",) and recorded_alone.actuators == ("a1",)
    assert set(recorded_alone.signals) == {"x1", "a1.motor", "a1.force"}
    found = compare(motions_at([bag, bag]))
    assert (
        set(found.against[0].judged) == {"x1", "a1.motor", "a1.force"} and found.against[0].worst.far == 0.0
    )


def test_what_moves_where_the_reference_is_at_rest_is_beyond_measure() -> None:
    def moving(name: str, end: float) -> Motion:
        x1 = Signal("x1", "m", np.array([0, 10**9]), np.array([0.0, end]))
        return Motion(name, "trajectory", {"x1": x1}, ("x1",), ())

    found = compare([moving("rest", 0.0), moving("slow", 0.1)], 0.5)
    assert found.words == "differs beyond measure: x1 of slow, against rest, which is zero there."
    assert found.within is False
    found = compare([moving("slow", 0.1), moving("far", 1e7)], 0.5)
    assert found.words == "differs beyond measure: x1 of far, against slow, as it diverges."
    assert "boundless" in difference_rows(found.against[0])[1]


def test_tests_without_a_signal_or_a_time_in_common_are_refused() -> None:
    one = Motion("one", "trajectory", {"x1": ramp("x1", [0, 10])}, ("x1",), ())
    other = Motion("other", "trajectory", {"y": ramp("y", [0, 10])}, ("y",), ())
    later = Motion("later", "trajectory", {"x1": ramp("x1", [100, 110])}, ("x1",), ())
    with pytest.raises(InputError, match="compare tests of the same rig"):
        compare([one, other])
    with pytest.raises(InputError, match="no time in common"):
        compare([one, later])


def test_the_page_shows_verdict_signals_measures_and_definitions(bag: Path, tmp_path: Path) -> None:
    (tmp_path / "late.yaml").write_text(write_spec(apply(PAPER, {"timing.tau4": 0.03})))
    found = compare(motions_at([str(bag), "paper", str(tmp_path / "late.yaml")]), 0.01)
    page = comparison_page(found)
    assert "more than 1 %" in page and "What is measured" in page
    for words in ("x1: difference", "Silva", "effective delay", 'id="comparison"'):
        assert words in page
    assert "http://" not in page.split("<main>")[1].split('id="comparison"')[0]
