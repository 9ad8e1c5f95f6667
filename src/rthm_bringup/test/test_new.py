"""A first spec: from a shipped one, and from a recording."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
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


def decay(folder: Path) -> None:
    """A bag and a folder of files of 1.2 kg on 12 N/m that was let go at 0.4 m."""
    t = np.arange(4001) * 0.005
    x = 0.4 * np.exp(-0.02 * t) * np.cos(3.16 * t) + 1e-4 * np.random.default_rng(0).normal(size=t.size)
    rows = "".join(f"{a:.3f},{b:.6f}\n" for a, b in zip(t, x, strict=True))
    (folder / "decay.csv").write_text("t [s],x [m]\n" + rows)
    for words in ("import decay.csv -o bag --map position:x1=x", "export bag -o files"):
        done = rthm(*words.split(), cwd=folder)
        assert done.returncode == 0, done.stderr


def test_a_first_spec_comes_from_a_bag_or_from_exported_files(tmp_path: Path) -> None:
    decay(tmp_path)
    done = rthm("new", "rig.yaml", "--from", "bag", "--json", "rig.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (
        done.stdout.startswith("rig.yaml\ndamping of x1: 0.0") and "assumed to be exactly 1 kg" in done.stdout
    )
    told = json.loads((tmp_path / "rig.json").read_text())
    assert [one["name"] for one in told["figures"]] == ["damping of x1", "stiffness of x1"]
    assert told["figures"][1]["value"] == pytest.approx(3.16**2, rel=0.01) and len(told["told"]) == 1
    done = rthm("new", "weighed.yaml", "--from", "files", "--mass", "1.2", cwd=tmp_path)
    assert done.returncode == 0 and "1 kg" not in done.stdout
    weighed = read_spec(tmp_path / "weighed.yaml")
    assert weighed.plant.mass == (1.2,) and weighed.plant.stiffness[0] == pytest.approx(12.0, rel=0.01)
    ran = rthm("diagnose", "bag", "--spec", "weighed.yaml", cwd=tmp_path)
    assert ran.returncode == 0 and ran.stdout.startswith(("match", "retuned")), ran.stdout


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ("new a.yaml --like papr", "there is no shipped spec 'papr'"),
        ("new a.yaml --like paper --from bag", "--like and --from are both given"),
        ("new a.yaml --mass 1", "--dof and --mass need a recording"),
        ("new a.yaml --from nothing", "nothing"),
        ("new no/a.yaml", "no is not a folder"),
        ("new .", "a folder, but must be a file"),
    ],
)
def test_what_cannot_be_begun_is_one_line_and_status_2(words: str, sentence: str, tmp_path: Path) -> None:
    done = rthm(*words.split(), cwd=tmp_path)
    assert done.returncode == 2 and sentence in done.stderr and done.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())
