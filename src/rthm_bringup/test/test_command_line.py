"""The command line: one line for every failure, the right exit status, JSON that every reader takes."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer import Abort
from typer.main import get_command

from rthm_bringup.cli.colour import GREEN, PLAIN, RED, YELLOW, coloured, is_coloured
from rthm_bringup.cli.main import application
from rthm_bringup.cli.output import plain, progress_bar, table
from rthm_bringup.cli.pace import Pace, size_in
from rthm_bringup.cli.reference import reference
from rthm_core.effects import BLOCKS, effect, kinds
from rthm_core.effects.blocks import family
from rthm_core.spec import read_spec, shipped_names, shipped_spec


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
        (["simulat"], "Did you mean 'simulate'?"),
        (["effects", "coulomb_frictoin"], "there is no effect 'coulomb_frictoin'; write coulomb_friction."),
        (["specs", "papr"], "there is no shipped spec 'papr', only decay, friction, paper"),
        (["simulate", "papr", "--duration", "1", "--out", "a.npz"], "a shipped one's name: paper is one."),
        (["simulate", "--duration", "1", "--out", "a.csv"], "--out is a.csv, but a trajectory is written as"),
        (["run", "no_such_spec"], "no_such_spec: there is no such file"),
        (["run", "--duration", "-1"], "The duration is -1 s, but must be from 0 to 1e6 s"),
        (["run", "--domain", "300"], "The domain is 300, but must be between 0 and 232"),
        (["dashboard", "--domain", "300"], "The domain is 300, but must be between 0 and 232"),
        (["dashboard", "--port", "70000"], "Invalid value for '--port'"),
        (["dashboard", "--namespace", "a b"], "The namespace is '/a b', but must be words"),
        (["run", "--external", "cook"], "'cook' is not a part of a test"),
        (
            ["run", "--virtual", "--duration", "0"],
            "A run with --virtual needs an end, but its duration is 0; give --duration.",
        ),
        (["run", "--virtual", "--plant", "external"], "A run with --virtual has only simulated parts"),
        (["run", "decay"], "and a run needs it"),
        (["check-driver", "decay"], "the spec describes a plant alone"),
        (["check-driver", "--seconds", "0"], "Invalid value for '--seconds'"),
        (["check-driver", "--swing", "nan"], "The swing is nan m"),
        (["check-driver", "--measure", "m.yaml"], "limits.command, rate, force, stale and ramp are missing"),
        (["zero", "--only", "colour"], "--only is 'colour', but must be one or more of position, velocity"),
        (["zero"], "limits.command, rate, force, stale and ramp are missing"),
        (["pretension"], "limits.command, rate, force, stale and ramp are missing"),
        (["node", "cook"], "'cook' is not a part of a test"),
        (["driver"], "A driver serves one rig; give exactly one of --python, --udp and --ros2-control."),
        (["driver", "--udp", "here", "--python", "rig.py:Rig"], "A driver serves one rig"),
        (["driver", "--udp", "here"], "limits.command, rate, force, stale and ramp are missing"),
        (["run", "--amplitude", "0"], "--amplitude is 0.0, but must be a number above 0; 1 is the whole"),
        (["energy", "no_such_bag"], "no_such_bag"),
        (["timing", "no_such_bag"], "no_such_bag"),
        (["report", "no_such_bag", "-o", "page.html"], "no_such_bag"),
        (["simulate", "--duration", "1", "--out", "no_such_folder/a.npz"], "no_such_folder is not a folder"),
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


@pytest.mark.parametrize(
    ("line", "colour"),
    [
        ("Stable; all periods and delays could grow 21.2-fold.", GREEN),
        ("within 2 %: differs by 0.4 % at most, x1 of a.npz, against paper.", GREEN),
        ("Timing mattered: late samples changed the motion by 4 %.", YELLOW),
        ("not stable: largest eigenvalue 1.02", RED),
        ("differs by 4 %, more than 2 %: x1 of a.npz, against paper.", RED),
        ("unexplained: Simulation and recording differ in the wire.", RED),
    ],
)
def test_a_verdict_stands_in_the_colour_of_its_meaning(line: str, colour: str) -> None:
    (shown,) = coloured([line])
    assert shown.startswith(colour) and shown.count(PLAIN) == 1
    assert shown.removeprefix(colour).replace(PLAIN, "") == line


def test_what_judges_nothing_has_no_colour() -> None:
    lines = ["x1 differs from the ideal system by 45 %.", "matches: none", "differs by 4 % at most: x1.", ""]
    assert coloured(lines) == lines


@pytest.mark.parametrize(
    ("terminal", "environment", "wanted"),
    [(True, {}, True), (False, {}, False), (True, {"NO_COLOR": "1"}, False), (True, {"TERM": "dumb"}, False)],
)
def test_only_a_terminal_that_wants_colour_gets_it(
    terminal: bool, environment: dict[str, str], wanted: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr("sys.stdout.isatty", lambda: terminal)
    assert is_coloured() is wanted


def test_work_of_hours_is_announced_once_and_not_begun_against_a_no() -> None:
    now, said = [0.0], []

    def ask(sentence: str) -> bool:
        said.append(sentence)
        return len(said) == 1

    quick, slow, refused = (Pace(1000.0, ask, lambda: now[0]) for _ in range(3))
    now[0] = 5.0
    slow.told(1.0)
    assert not said  # the pace is not known yet
    now[0] = 12.0
    quick.told(100.0)
    assert not said
    slow.told(1.0)
    slow.told(2.0)
    assert said == ["About 3.3 hours to go at this pace."]
    with pytest.raises(Abort):
        refused.told(1.0)


def test_what_was_done_before_says_nothing_about_the_pace_and_the_size_is_told(tmp_path: Path) -> None:
    now, said = [0.0], []
    (tmp_path / "batch").write_bytes(bytes(2000))
    resumed = Pace(
        1000.0,
        lambda sentence: not said.append(sentence),
        lambda: now[0],
        size_in(tmp_path, "1000 loops"),
        resumes=True,
    )
    resumed.told(900.0)  # by an earlier start
    now[0] = 100.0
    resumed.told(901.0)
    assert said == [f"About 2.8 hours to go at this pace: 1000 loops, 2.22 kB in {tmp_path} at the end."]


def test_who_says_yes_is_told_and_not_asked(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    monkeypatch.setattr("rthm_bringup.cli.pace.LOOKED", 0.0)
    monkeypatch.setattr("rthm_bringup.cli.pace.LONG", 0.0)
    monkeypatch.setattr("typer.confirm", lambda *words, **options: False)
    with progress_bar("loops", 2.0, yes=True) as report:
        report(1.0)
    assert "to go at this pace." in capsys.readouterr().err
    with pytest.raises(Abort), progress_bar("loops", 2.0) as report:
        report(1.0)


def test_help_is_there_before_anything_is_installed(tmp_path: Path) -> None:
    root = Path(__file__).parents[3]
    for file in [*root.glob("scripts/*"), root / "docs/reference/command-line.md"]:
        copy = tmp_path / file.relative_to(root)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(file, copy)
    for words in ([], ["--help"], ["sweep", "--help"], ["compare", "-h"]):
        done = subprocess.run([tmp_path / "scripts/rthm", *words], capture_output=True, text=True, check=True)
        name = " ".join(["rthm", *(word for word in words if not word.startswith("-"))])
        assert done.stdout.startswith(f"Usage: {name} ") and "-h, --help" in done.stdout
        assert done.stdout in reference()
    assert not (tmp_path / ".venv").exists()


def test_the_list_of_verbs_is_whole_and_no_help_has_marks_of_a_docstring() -> None:
    listed = rthm("--help").stdout.partition("Commands:")[2]
    assert listed and "..." not in listed
    assert "`" not in reference().partition("## rthm")[2].replace("```", "")


def test_without_a_verb_there_is_help() -> None:
    done = rthm()
    assert done.returncode == 0 and done.stdout == rthm("--help").stdout
    assert "simulate" in done.stdout and not done.stderr


def test_the_version_is_told() -> None:
    done = rthm("--version")
    assert done.returncode == 0 and re.fullmatch(r"rthm \d+\.\d+\.\d+\n", done.stdout)


def test_a_shipped_spec_that_was_printed_can_be_simulated(tmp_path: Path) -> None:
    assert [line.split()[0] for line in rthm("specs").stdout.splitlines()] == list(shipped_names())
    (tmp_path / "mine.yaml").write_text(rthm("specs", "decay").stdout)
    assert read_spec(tmp_path / "mine.yaml") == shipped_spec("decay")


def test_every_effect_is_listed_with_its_parameters() -> None:
    listed = json.loads(rthm("effects", "--json", "-").stdout)["effects"]
    told = {(one["block"], one["kind"]): one for one in listed}
    assert len(told) == len(listed)
    for block in BLOCKS:
        for kind in kinds(block):
            one = told[family(block), kind]
            assert one["words"] and list(one["parameters"]) == list(effect(kind, block).parameters)
    assert "F_f sign(v)" in rthm("effects", "coulomb_friction").stdout


def test_every_example_of_a_help_is_a_command_that_is_understood() -> None:
    verbs = get_command(application())
    for name, verb in verbs.commands.items():
        examples = [line.strip() for line in (verb.epilog or "").splitlines() if line.startswith("  rthm")]
        assert examples, name
        for example in examples:
            program, its_name, *words = shlex.split(example.partition(" > ")[0])
            assert (program, its_name) == ("rthm", name)
            verb.make_context(name, words)


SHELLS = {
    "bash": lambda words: {"COMP_WORDS": words, "COMP_CWORD": str(len(words.split()) - 1)},
    "zsh": lambda words: {"_TYPER_COMPLETE_ARGS": words},
    "fish": lambda words: {"_TYPER_COMPLETE_ARGS": words, "_TYPER_COMPLETE_FISH_ACTION": "get-args"},
}


@pytest.mark.parametrize("shell", SHELLS)
def test_a_shell_completes_verbs_options_and_specs(shell: str) -> None:
    def offered(words: str) -> set[str]:
        asked = os.environ | {"_RTHM_COMPLETE": f"complete_{shell}"} | SHELLS[shell](words)
        return set(re.findall(r"[\w-]+", rthm(env=asked).stdout))

    assert "simulate" in offered("rthm sim") and "diagnose" not in offered("rthm sim")
    assert "--duration" in offered("rthm run --du")
    assert {"paper", "paper_noisy"} <= offered("rthm run pap")


def test_the_reference_page_is_what_the_helps_say() -> None:
    page = Path(__file__).parents[3] / "docs" / "reference" / "command-line.md"
    assert page.read_text(encoding="utf-8") == reference(), (
        "run: python -m rthm_bringup.cli.reference docs/reference/command-line.md"
    )
