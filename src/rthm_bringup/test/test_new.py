"""A first spec: from a shipped one, and from a recording."""

from __future__ import annotations

from pathlib import Path

import pytest

from rthm_core.spec import apply, parameters, read_spec, shipped_names, shipped_spec
from rthm_core.spec.commenting import commented_spec
from rthm_core.spec.first import SPREAD, first_spec

from .test_command_line import rthm


@pytest.mark.parametrize("name", shipped_names())
def test_comments_change_nothing_and_every_entry_has_one(name: str) -> None:
    spec = shipped_spec(name)
    text = commented_spec(spec, "Two\nparagraphs.", {"plant": "A note.", "plant.mass": "Another."})
    assert read_spec(text) == spec
    assert max(map(len, text.splitlines())) <= 150  # a matrix cannot be broken
    assert text.startswith("# Two\n# paragraphs.\n/**:\n")
    for one in parameters(spec):
        assert f"{one.unit}; {one.description}" in text or one.unit in ("", "1")
        assert one.description in text
    assert text.index("# A note.") < text.index(" plant:") < text.index("# Another.") < text.index(" mass:")


@pytest.mark.parametrize("name", shipped_names())
def test_a_first_spec_is_the_shipped_one_with_an_uncertainty(name: str) -> None:
    spec, text = read_spec(first_spec(name)), first_spec(name)
    assert apply(spec, {"uncertainty": None}) == apply(shipped_spec(name), {"uncertainty": None})
    assert spec.uncertainty.plant.stiffness == SPREAD["stiffness"]
    assert spec.uncertainty.plant.mass == (SPREAD["mass"] if spec.is_loop else 0.0)
    assert "with 0, a value counts as" in text and ("Weigh it." in text) != spec.is_loop


def test_new_writes_a_file_that_runs_and_overwrites_nothing(tmp_path: Path) -> None:
    done = rthm("new", "mine.yaml", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, "mine.yaml\n")
    text = (tmp_path / "mine.yaml").read_text()
    assert text == first_spec("paper")
    again = rthm("new", "mine.yaml", "--like", "decay", cwd=tmp_path)
    assert again.returncode == 2 and "mine.yaml is there already" in again.stderr
    assert (tmp_path / "mine.yaml").read_text() == text
    ran = rthm("simulate", "mine.yaml", "--duration", "1", "--out", "motion.npz", cwd=tmp_path)
    assert ran.returncode == 0, ran.stderr
