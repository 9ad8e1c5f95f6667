"""``rthm compare`` and ``rthm runs``: one screen, a verdict, the right exit status, no traceback."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from rthm_bringup.cli import main
from rthm_core.engine import simulate
from rthm_core.spec import shipped_spec, shipped_text

Answer = tuple[int, str, str]
Rthm = Callable[..., Answer]


@pytest.fixture
def rthm(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Rthm:
    """The command line, in this process and an empty folder: exit status, output, errors."""
    monkeypatch.chdir(tmp_path)

    def run(*words: str) -> Answer:
        monkeypatch.setattr(sys, "argv", ["rthm", *words])
        with pytest.raises(SystemExit) as ended:
            main()
        told = capsys.readouterr()
        assert isinstance(ended.value.code, int)
        return ended.value.code, told.out, told.err

    return run


def trajectory(file: str, **changed: object) -> None:
    """A trajectory of the paper's test, some arrays of it changed; None leaves one out."""
    found = simulate(shipped_spec("paper"), 2.0, 0.01)
    arrays = {key: one for key, one in vars(found).items() if key != "energies"} | found.energies | changed
    np.savez(file, **{key: one for key, one in arrays.items() if one is not None})


def scaled(file: str, factor: float) -> None:
    """The same with its plant moving more by a factor."""
    position = simulate(shipped_spec("paper"), 2.0, 0.01).plant_position
    trajectory(file, plant_position=position * factor)


def test_what_differs_by_more_than_the_tolerance_is_status_1(rthm: Rthm) -> None:
    trajectory("a.npz")
    scaled("b.npz", 1.043)
    status, out, err = rthm("compare", "a.npz", "b.npz", "--tolerance", "2")
    assert (status, err) == (1, "")
    assert out.splitlines()[-1] == "differs by 4.3 %, more than 2 %: x1 of b.npz, against a.npz."
    status, out, _ = rthm("compare", "a.npz", "b.npz", "--tolerance", "5")
    assert status == 0
    assert out.splitlines()[-1].startswith("within 5 %: differs by 4.3 % at most, x1 of b.npz")
    assert len(out.splitlines()) <= 30


def test_without_a_tolerance_the_difference_is_told_and_the_status_is_0(rthm: Rthm) -> None:
    trajectory("a.npz")
    scaled("b.npz", 1.043)
    status, out, _ = rthm("compare", "a.npz", "b.npz")
    assert status == 0
    assert out.splitlines()[-1].startswith("differs by 4.3 % at most: x1 of b.npz")
    assert rthm("compare", "a.npz", "b.npz", "--only", "x2", "--tolerance", "0")[0] == 0


def test_the_json_has_the_keys_of_its_page(rthm: Rthm) -> None:
    trajectory("a.npz")
    scaled("b.npz", 1.043)
    status, out, _ = rthm("compare", "a.npz", "b.npz", "--tolerance", "2", "--json", "-")
    told = json.loads(out)
    assert status == 1 and told["within"] is False and told["tolerance"] == pytest.approx(0.02)
    (one,) = told["comparisons"]
    assert (one["signal"], one["nrmse"]) == ("x1", pytest.approx(0.043))
    x1 = one["signals"]["x1"]
    assert x1["amplitude_error"]["value"] == pytest.approx(0.043) and x1["peak"] == pytest.approx(0.043)
    assert abs(one["offset"]["value"]) < 1e-9
    assert [source["kind"] for source in told["sources"]] == ["trajectory", "trajectory"]
    page = (Path(__file__).parents[3] / "docs" / "how-to" / "compare-tests.md").read_text(encoding="utf-8")
    keys = {*told, *one, *x1, *told["sources"][0]}
    assert [key for key in sorted(keys) if f"`{key}`" not in page] == []


def test_a_page_is_written_beside_the_text(rthm: Rthm) -> None:
    trajectory("a.npz")
    status, out, _ = rthm("compare", "a.npz", "paper", "--out", "page.html")
    assert status == 0 and "page.html" in out.splitlines()
    assert ": difference" in Path("page.html").read_text(encoding="utf-8")


WRONG = [
    (["a.npz"], "1 source is given, but a comparison needs two or more"),
    (["a.npz", "none.npz"], "none.npz is not there; give a recording"),
    (["a.npz", "papr"], "papr is not there; give a recording"),
    (["a.npz", "data.csv"], "data.csv is none of the files that can be compared"),
    (["a.npz", "empty"], "is a folder without .mcap or .db3 files"),
    (["a.npz", "text.npz"], "text.npz is not an npz file that can be read"),
    (["a.npz", "cut.npz"], "cut.npz is not an npz file that can be read"),
    (["a.npz", "objects.npz"], "objects.npz is not an npz file that can be read"),
    (["a.npz", "no_t.npz"], "no_t.npz has no array t"),
    (["a.npz", "back.npz"], "must be 201 ascending times in s"),
    (["a.npz", "words.npz"], "plant_position of words.npz is an array"),
    (["a.npz", "wide.npz", "paper"], "plant_position of wide.npz has 3 columns, but the other tests have 1"),
    (["a.npz", "unknown.npz"], "unknown.npz has no known position"),
    (["a.npz", "later.npz"], "have no time in common"),
    (["a.npz", "noise.mcap"], "noise.mcap holds no message that can be read"),
    (["a.npz", "broken.yaml"], "broken.yaml: "),
    (["paper", "other.yaml"], "compare tests of the same rig"),
    (["a.npz", "a.npz", "--only", "x7"], "x7 is not a signal of both a.npz and a.npz, which have x1, x2"),
    (["a.npz", "a.npz", "--tolerance", "-1"], "The tolerance is -1 %, but must be a number from 0"),
    (["a.npz", "a.npz", "--tolerance", "nan"], "The tolerance is nan %"),
    (["a.npz", "a.npz", "--tolerance", "two"], "Invalid value for '--tolerance'"),
    (["paper", "paper", "--duration", "0"], "paper would be simulated for 0 s"),
    (["paper", "paper", "--duration", "1e9"], "give another --duration"),
    (["a.npz", "a.npz", "--out", "data.csv/page.html"], "cannot be written"),
    ([], "Missing argument 'A B ...'"),
]


def lay_out_wrong_files() -> None:
    trajectory("a.npz")
    Path("data.csv").write_text("t,x\n0,1\n")
    Path("empty").mkdir()
    Path("text.npz").write_text("no archive")
    Path("cut.npz").write_bytes(Path("a.npz").read_bytes()[:3000])
    np.savez("objects.npz", t=np.array([None, {}], dtype=object), plant_position=np.zeros((2, 1)))
    trajectory("no_t.npz", t=None)
    trajectory("back.npz", t=np.linspace(2.0, 0.0, 201))
    trajectory("words.npz", plant_position=np.array([["a"]] * 201))
    trajectory("wide.npz", plant_position=np.zeros((201, 3)))
    unknown = np.full((201, 1), np.nan)
    trajectory("unknown.npz", plant_position=unknown, numerical_position=unknown)
    trajectory("later.npz", t=np.linspace(100.0, 102.0, 201))
    Path("noise.mcap").write_bytes(bytes(range(256)))
    Path("broken.yaml").write_text("plant: [1,")
    Path("other.yaml").write_text(shipped_text("decay").replace('"x1"', '"y"'))


@pytest.mark.parametrize(("words", "sentence"), WRONG, ids=[" ".join(words) or "none" for words, _ in WRONG])
def test_wrong_input_is_one_sentence_and_status_2(rthm: Rthm, words: list[str], sentence: str) -> None:
    lay_out_wrong_files()
    status, out, err = rthm("compare", *words)
    assert (status, out) == (2, ""), err
    assert sentence in err
    assert err.startswith("rthm: ") and err.count("\n") == 1 and "fault in this program" not in err


def test_an_index_of_a_folder_is_told_and_sorted(rthm: Rthm) -> None:
    Path("out").mkdir()
    trajectory("out/long.npz")
    trajectory("out/short.npz", t=np.linspace(0.0, 1.0, 201))
    status, out, _ = rthm("runs", "--sort", "length", "--out", "index.html")
    assert status == 0
    assert [line.split()[0] for line in out.splitlines()[1:3]] == ["long.npz", "short.npz"]
    assert "long.npz" in Path("index.html").read_text(encoding="utf-8")
    assert [run["duration"] for run in json.loads(rthm("runs", "out", "--json", "-")[1])["runs"]] != []


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["runs"], "out is not a folder of runs; rthm run makes out/ with the first one"),
        (["runs", "a.npz"], "a.npz is not a folder of runs"),
        (["runs", ".", "--sort", "colour"], "--sort is 'colour', but must be one of date, name, spec"),
    ],
)
def test_an_index_of_nothing_is_one_sentence(rthm: Rthm, words: list[str], sentence: str) -> None:
    trajectory("a.npz")
    status, out, err = rthm(*words)
    assert (status, out) == (2, "") and sentence in err and err.count("\n") == 1
