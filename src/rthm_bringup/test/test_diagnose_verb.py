"""``rthm diagnose`` writes what it is asked for, and one bad path costs nothing else."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from rthm_analysis.diagnosis.result import Diagnosis, RecordingFit
from rthm_bringup.cli.main import main
from rthm_core.spec import shipped_spec

SAID = Diagnosis(
    verdict="explained", blocks=(), located=("plant",), physics=(), retuned={}, alternatives=(), fits=(),
    detection_limits={}, next_experiment="To confirm dry friction: a harmonic load.", words="Words.",
    patched="/**: {}\n", next_experiment_spec="/**: {next}\n", next_experiment_gain=14.0,
)  # fmt: skip


@pytest.fixture
def told(monkeypatch: pytest.MonkeyPatch) -> list[Diagnosis]:
    said = [SAID]
    recording = SimpleNamespace(notes=(), name="bag", known_spec=lambda: shipped_spec("paper"))
    monkeypatch.setattr("rthm_analysis.recording.read_recording", lambda bag: recording)
    monkeypatch.setattr("rthm_analysis.diagnosis.diagnose_together", lambda *given: said[0])
    return said


def status(monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    monkeypatch.setattr("sys.argv", ["rthm", "diagnose", "bag", *words])
    with pytest.raises(SystemExit) as left:
        main()
    return int(left.value.code or 0)


def test_the_next_test_is_written_as_a_spec(
    told: list[Diagnosis], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    file, numbers = tmp_path / "next.yaml", tmp_path / "said.json"
    assert status(monkeypatch, "--next", str(file), "--json", str(numbers)) == 0
    assert file.read_text() == SAID.next_experiment_spec
    assert json.loads(numbers.read_text())["next_experiment_gain"] == 14.0


def test_where_there_is_none_that_is_said_and_nothing_written(
    told: list[Diagnosis], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    told[0] = replace(SAID, verdict="improved", next_experiment_spec=None, next_experiment_gain=None)
    file = tmp_path / "next.yaml"
    assert status(monkeypatch, "--next", str(file)) == 1
    assert not file.exists() and f"{file} is not written" in capsys.readouterr().out


@pytest.mark.parametrize("bad", ["--next", "--patched"])
def test_what_cannot_be_written_is_one_sentence_and_the_rest_is_there(
    bad: str, told: list[Diagnosis], monkeypatch: pytest.MonkeyPatch, tmp_path: Path,
    capsys: pytest.CaptureFixture,
) -> None:  # fmt: skip
    places = {key: str(tmp_path / key.strip("-")) for key in ("--next", "--patched", "--json")}
    places[bad] = str(tmp_path / "nowhere" / "file")
    assert status(monkeypatch, *(word for pair in places.items() for word in pair)) == 2
    printed = capsys.readouterr()
    assert "explained: Words." in printed.out and printed.err.count("\n") == 1
    assert all(Path(place).is_file() for key, place in places.items() if key != bad)


def test_each_of_several_recordings_is_told(
    told: list[Diagnosis], monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    errors = {"nominal": 0.3, "retuned": 0.3, "explained": 0.01, "noise_floor": 0.01}
    fits = [RecordingFit(name, (0.0, 9.0), name == "high", {"x1": errors}) for name in ("low", "high")]
    told[0] = replace(SAID, recordings=tuple(fits))
    numbers = tmp_path / "said.json"
    assert status(monkeypatch, "other", "--json", str(numbers)) == 0
    said = capsys.readouterr().out
    assert "error of x1 in low (fitted): 30 % as specified, 1 % explained; the noise alone is 1 %" in said
    assert "error of x1 in high (held out)" in said
    assert [one["held_out"] for one in json.loads(numbers.read_text())["recordings"]] == [False, True]
