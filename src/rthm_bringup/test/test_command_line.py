"""The command line: one line for every failure, the right exit status, JSON that every reader takes."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rthm_bringup.cli.output import plain, table


def rthm(*words: str, **options: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "rthm_bringup", *words], capture_output=True, text=True, check=False, **options
    )


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["juggle"], "No such command 'juggle'; see rthm --help."),
        (["run", "--dance"], "No such option: --dance"),
        (["run", "--duration", "long"], "Invalid value for '--duration'"),
        (["run", "no_such_spec"], "no_such_spec: there is no such file"),
        (["run", "--duration", "-1"], "The duration is -1 s, but must be from 0 to 1e6 s"),
        (["run", "--domain", "300"], "The domain is 300, but must be between 0 and 232"),
        (["run", "--external", "cook"], "'cook' is no part of a test"),
        (["run", "--virtual", "--duration", "0"], "A virtual run without end is asked for"),
        (["run", "--virtual", "--plant", "external"], "A virtual run has only simulated parts"),
        (["run", "decay"], "and a run needs it"),
        (["check-driver", "decay"], "the spec describes a plant alone"),
        (["check-driver", "--seconds", "0"], "Invalid value for '--seconds'"),
        (["check-driver", "--swing", "nan"], "The swing is nan m"),
        (["check-driver", "--measure", "m.yaml"], "limits.command, rate, force, stale and ramp are missing"),
        (["zero", "--only", "colour"], "--only is 'colour', but must be one or more of position, velocity"),
        (["zero"], "limits.command, rate, force, stale and ramp are missing"),
        (["pretension"], "limits.command, rate, force, stale and ramp are missing"),
        (["node", "cook"], "'cook' is no part of a test"),
        (["driver"], "A driver has one rig; give it by one of --python, --udp and --ros2-control."),
        (["driver", "--udp", "here", "--python", "rig.py:Rig"], "A driver has one rig"),
        (["driver", "--udp", "here"], "limits.command, rate, force, stale and ramp are missing"),
        (["run", "--amplitude", "0"], "--amplitude is 0.0, but must be a number above 0; 1 is the whole"),
        (["energy", "no_such_bag"], "no_such_bag"),
        (["timing", "no_such_bag"], "no_such_bag"),
        (["report", "no_such_bag", "-o", "page.html"], "no_such_bag"),
        (["simulate", "--duration", "1", "--out", "no_such_folder/a.npz"], "no_such_folder is no folder"),
    ],
)
def test_bad_input_is_one_line_and_status_2(words: list[str], sentence: str, tmp_path: Path) -> None:
    done = rthm(*words, cwd=tmp_path)
    assert done.returncode == 2, done.stderr
    assert sentence in done.stderr
    assert done.stderr.count("\n") == 1
    assert done.stdout == ""
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_written_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    done = rthm("run", "--out", str(tmp_path / "file" / "out"))
    assert done.returncode == 2
    assert "cannot be written (not a directory)" in done.stderr


def test_help_imports_nothing_heavy() -> None:
    code = "import sys; from rthm_bringup.cli.main import application; application()"
    heavy = ("numpy", "pydantic", "numba", "rclpy", "rich", "bokeh", "rthm_core.spec")
    code += f"; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"


def test_every_verb_has_help_that_names_its_options() -> None:
    listed = rthm("--help").stdout
    for verb in ("run", "simulate", "energy", "timing", "report", "check-driver"):
        assert f"  {verb} " in listed
        assert "--json" in rthm(verb, "--help").stdout


values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)


@given(values)
def test_whatever_is_told_is_json(value: object) -> None:
    text = json.dumps(plain(value), allow_nan=False)
    assert json.dumps(json.loads(text)) == text


def test_numbers_that_are_not_finite_become_null() -> None:
    assert plain({"a": np.array([1.0, np.nan]), "b": np.float64(np.inf), 3: np.int64(4)}) == {
        "a": [1.0, None],
        "b": None,
        "3": 4,
    }


def test_columns_stand_under_each_other() -> None:
    assert table([("a", "1"), ("long", "10")]) == ["a      1", "long  10"]
    assert table([]) == []
