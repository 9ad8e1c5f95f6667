"""The page of a diagnosis says what the diagnosis says, and needs nothing else."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bokeh.models import Scatter

from rthm_analysis.diagnosis.missing.binned import spread_over
from rthm_analysis.diagnosis.result import (
    Alternative,
    Curve,
    Diagnosis,
    Fit,
    Limit,
    Mismatch,
    Physics,
    RecordingFit,
    Value,
)
from rthm_analysis.recording import read_recording
from rthm_analysis.report.diagnosis import diagnosis_page, write_diagnosis
from rthm_analysis.report.diagnosis_drawing import drawing, times_noise
from rthm_analysis.report.diagnosis_figures import curve_plot, energy_plot
from rthm_core.spec import shipped_spec

from .conftest import rosbag2
from .loop import recorded

TIME = np.linspace(40.0, 60.0, 500)
FOUND = Physics(
    "plant",
    "coulomb_friction",
    "x1",
    {"force": Value(0.118, 0.002, "N")},
    "Dry friction <of> x1.",
    -0.41,
    0.93,
)
SAID = Diagnosis(
    verdict="explained",
    blocks=(Mismatch("plant", 7.3, True), Mismatch("wire", 1.0, False)),
    located=("plant",),
    physics=(FOUND,),
    retuned={},
    alternatives=(Alternative("plant", "stribeck_friction", 0.0131, False),),
    fits=(
        Fit("plant", "x1", None, (0.0, 40.0), (40.0, 60.0),
            {"nominal": 0.34, "retuned": 0.21, "explained": 0.012},
            TIME, np.sin(TIME), 0.9 * np.sin(TIME), 0.95 * np.sin(TIME), np.sin(TIME)),
    ),
    detection_limits={"plant.coulomb_friction.force": Limit(0.004, "N")},
    next_experiment="A slow sweep.",
    words="Simulation and recording differ in the plant.",
    curves=(Curve("plant", "v", "m/s", np.linspace(-1, 1, 9), np.ones(9), np.ones(9), None, 0.5),),
    notes=("One note.",),
    patched="/**: {}",
)  # fmt: skip


@pytest.fixture(scope="module")
def page(tmp_path_factory) -> str:
    folder = tmp_path_factory.mktemp("page")
    spec = shipped_spec("paper")
    html = folder / "why.html"
    write_diagnosis(SAID, read_recording(rosbag2(folder / "bag", recorded(spec, 1.0))), spec, html)
    return Path(html).read_text(encoding="utf-8")


def test_the_page_carries_the_numbers_of_the_diagnosis(page: str) -> None:
    (text,) = re.findall(r'id="diagnosis">(.*?)</script>', page, flags=re.S)
    assert json.loads(text.replace("<\\/", "</")) == json.loads(json.dumps(SAID.as_dict()))


def test_the_located_block_is_framed_in_the_drawing_and_no_other(page: str) -> None:
    assert page.count('class="frame"') == 1
    assert 'class="mark located">plant: 7.3 x noise<' in page
    assert 'class="mark">1 x noise<' in page


def test_an_exact_replay_is_called_exact() -> None:
    assert times_noise(0.0) == "exact"
    assert times_noise(7.31234) == "7.31 x noise"
    assert times_noise(54321.0) == "5.4e+04 x noise"


def test_the_drawing_of_a_plant_alone_has_no_links(tmp_path: Path) -> None:
    bag = read_recording(rosbag2(tmp_path / "bag", recorded(shipped_spec("paper"), 1.0)))
    drawn = drawing(SAID, bag, shipped_spec("decay"))
    assert drawn.count('class="frame"') == 1 and "Known forces" in drawn
    assert "Controller" not in drawn


def test_the_law_of_dry_friction_is_drawn_as_a_jump_and_not_as_a_ramp() -> None:
    (curve,) = SAID.curves
    v = np.sin(np.linspace(0.0, 100.0, 20_000))
    plot = curve_plot(replace(curve, law=spread_over(v, -0.05 * np.sign(v))))
    (law,) = [one for one in plot.renderers if one.name == "named physics"]
    assert isinstance(law.glyph, Scatter)
    assert set(np.round(law.data_source.data["y"], 9)) == {-0.05, 0.05}
    assert np.diff(np.sort(law.data_source.data["x"])).max() < 0.01
    assert not any(one.name == "named physics" for one in curve_plot(curve).renderers)


def test_energies_of_what_was_found_stand_above_those_of_the_delays() -> None:
    plot = energy_plot({"coulomb friction (plant)": -0.41}, {"position cancellation (E_fx)": 0.2})
    assert list(plot.y_range.factors) == [
        "position cancellation (E_fx): +0.2 J",
        "coulomb friction (plant): -0.41 J",
    ]


def test_the_page_shows_the_energy_of_the_delays_beside_what_was_found(page: str) -> None:
    for name in ("coulomb friction (plant): -0.41 J", "position cancellation (E_fx): "):
        assert name in page


def test_words_are_shown_as_text_and_the_page_needs_no_network(page: str) -> None:
    assert "cannot distinguish it" in page and "One note." in page and "A slow sweep." in page
    assert "Dry friction &lt;of&gt; x1." in page
    assert "Dry friction <of>" not in page.split("application/json")[0]
    assert "0.118" in page and "93 %" in page
    assert "<script src=" not in page and "<link" not in page


def test_every_heading_has_a_link_to_what_explains_it(page: str) -> None:
    assert page.count('</h2><a class="about" href="') == page.count("<section ") > 5


def test_a_page_of_several_recordings_has_a_row_for_each(tmp_path: Path) -> None:
    bag = read_recording(rosbag2(tmp_path / "bag", recorded(shipped_spec("paper"), 1.0)))
    errors = {"nominal": 0.3, "retuned": 0.3, "explained": 0.012, "noise_floor": 0.011}
    fits = [RecordingFit(name, (0.0, 9.0), name == "high", {"x1": errors}) for name in ("low", "high")]
    html = diagnosis_page(replace(SAID, recordings=tuple(fits)), bag, shipped_spec("paper"))
    assert "<h1>Diagnosis: low, high</h1>" in html
    rows = re.findall(r"<tr><td>(low|high)</td><td>([a-z ]+)</td><td>x1</td>", html)
    assert rows == [("low", "fitted"), ("high", "held out")]
    assert "Recording by recording" not in diagnosis_page(SAID, bag, shipped_spec("paper"))
