"""What the tutorials and how-to pages print is what the commands print."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from pages import ROOT, agrees, follow

from rthm_analysis.stability import spectral_radius
from rthm_core.spec import apply, shipped_spec

pytestmark = pytest.mark.usefixtures("nothing_left")
HOSTS = ROOT / "docs" / "tutorials" / "three_hosts.md"
"""A tutorial of several hosts (`test_tutorial_hosts`)."""
PAGES = [
    ROOT / "README.md",
    *(page for page in sorted((ROOT / "docs" / "tutorials").glob("*.md")) if page != HOSTS),
    pytest.param(ROOT / "docs" / "how-to" / "answers.md", marks=pytest.mark.long),
    pytest.param(ROOT / "docs" / "how-to" / "compare-tests.md", marks=pytest.mark.long),
    ROOT / "docs" / "how-to" / "test-a-component.md",
]
LARGEST_PICTURE = 150_000
"""Bytes of a picture that a page shows."""
EFFECT = ROOT / "docs" / "how-to" / "add-an-effect.md"
WORST = """
import numpy, rthm
spec = rthm.load("rig.yaml")
recorded, run = rthm.read("rig/bag"), rthm.simulate(spec, 20.0, sample=spec.timing.td2)
table = recorded.tables["numerical/state"]
tick = numpy.rint(recorded.seconds(table.stamp_ns) / spec.timing.td2).astype(int)
print(abs(table.position - run.numerical_position[tick]).max())
"""
"""Largest difference between node and engine of x2, which is measured without noise, m."""


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_tutorial_prints_what_its_commands_print(
    environment: dict[str, str], tmp_path: Path, page: Path
) -> None:
    follow(page, tmp_path, environment)


def test_an_effect_of_ones_own_is_found_by_name_and_moves_nodes_as_the_engine(
    environment: dict[str, str], tmp_path: Path
) -> None:
    follow(EFFECT, tmp_path, environment)
    variables = environment | {"PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-c", WORST]
    done = subprocess.run(command, cwd=tmp_path, env=variables, check=True, capture_output=True, text=True)
    assert float(done.stdout) < 1e-9


def test_the_pictures_of_the_readme_are_there_and_small() -> None:
    shown = re.findall(r'<img src="([^"]+)"', (ROOT / "README.md").read_text(encoding="utf-8"))
    assert shown
    assert all(0 < (ROOT / one).stat().st_size < LARGEST_PICTURE for one in shown)


def test_the_factors_of_the_first_tutorial_are_where_stability_is_lost() -> None:
    text = (ROOT / "docs" / "tutorials" / "first_test.md").read_text(encoding="utf-8")
    plain, predicted = (float(one) for one in re.findall(r"factor of (\d+\.\d+)", text))
    paper = shipped_spec("paper")
    for spec, factor in ((paper, plain), (apply(paper, {"actuator.compensator": "polynomial"}), predicted)):
        assert spectral_radius(spec.scaled_timing(round(factor - 0.01, 3))) < 1.0
        assert spectral_radius(spec.scaled_timing(round(factor + 0.01, 3))) > 1.0


def test_a_number_that_is_not_printed_is_noticed() -> None:
    assert agrees(["E  +1.000000e+00 J", "...", "z"], ["E  +1.000001e+00 J", "x", "y", "z"])
    assert not agrees(["E  +1.000000e+00 J"], ["E  +1.001000e+00 J"])
    assert not agrees(["E  1 J", "..."], ["F  1 J"])
    assert not agrees(["a"], ["a", "b"])
