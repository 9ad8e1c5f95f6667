"""The page of a diagnosis says what the diagnosis says, and needs nothing else."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.diagnosis.result import Alternative, Curve, Diagnosis, Fit, Limit, Mismatch, Physics, Value
from rthm_analysis.recording import read_recording
from rthm_analysis.report.diagnosis import write_diagnosis
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


def test_the_located_block_is_marked_in_the_drawing(page: str) -> None:
    assert "plant: 7.3 x noise" in page
    assert page.count('stroke="#d55e00"') == 1


def test_words_are_shown_as_text_and_the_page_needs_no_network(page: str) -> None:
    assert "cannot be told apart" in page and "One note." in page and "A slow sweep." in page
    assert "0.118" in page and "93 %" in page
    assert "<script src=" not in page and "<link" not in page
