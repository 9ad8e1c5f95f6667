"""Pictures of a frequency response and of a simulated test."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.report.trajectory_picture import draw as draw_trajectory
from rthm_analysis.response import response
from rthm_analysis.response.picture import draw as draw_response
from rthm_core.engine import simulate
from rthm_core.errors import InputError
from rthm_core.spec import shipped_spec

PAPER = shipped_spec("paper")


def test_a_response_is_drawn_with_its_margin_and_every_way(tmp_path: Path) -> None:
    import matplotlib

    with matplotlib.rc_context({"svg.fonttype": "none"}):
        draw_response(response(PAPER, np.linspace(0.5, 5.0, 9)), "Stable: by far.", tmp_path / "bode.svg")
    drawn = (tmp_path / "bode.svg").read_text()
    for words in ("Stable: by far.", "amplitude (m/N)", "phase (deg)", "delays and holds", "sampled"):
        assert words in drawn
    for words in (
        "loop opened at the command of a1",
        "gain margin 1.41 x",
        "phase margin -3.7 deg",
        "delay margin",
    ):
        assert words in drawn


def test_a_response_at_two_frequencies_is_no_picture(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="a curve takes 3"):
        draw_response(response(PAPER, np.array([1.0, 2.0])), "", tmp_path / "bode.svg")


def test_a_simulated_test_is_drawn_with_units(tmp_path: Path) -> None:
    import matplotlib

    run = simulate(PAPER, 2.0, 0.01)
    columns = {"t": run.t, "plant_position": run.plant_position, "actuator_force": run.actuator_force}
    with matplotlib.rc_context({"svg.fonttype": "none"}):
        draw_trajectory(columns | run.energies, tmp_path / "run.svg")
    drawn = (tmp_path / "run.svg").read_text()
    for words in ("position (m)", "force (N)", "energy (J)", "E_fx", "time (s)"):
        assert words in drawn
    assert "reference" not in drawn and "ideal" not in drawn


def test_the_ideal_system_is_drawn_beside_the_test(tmp_path: Path) -> None:
    import matplotlib

    run, ideal = simulate(PAPER, 2.0, 0.01), simulate(PAPER, 2.0, 0.05, "ideal")
    columns = {"t": run.t, "plant_position": run.plant_position, "numerical_position": run.numerical_position}
    with matplotlib.rc_context({"svg.fonttype": "none"}):
        draw_trajectory(columns, tmp_path / "run.svg", ideal)
    drawn = (tmp_path / "run.svg").read_text()
    assert "plant, ideal" in drawn and "numerical, ideal" in drawn
