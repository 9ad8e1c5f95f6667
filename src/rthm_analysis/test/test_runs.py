"""The index of runs says of each what it left, and of one that is damaged what is missing."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.recording.metadata import Summary
from rthm_analysis.report import write_report
from rthm_analysis.report.runs import write_runs
from rthm_analysis.runs import Run, runs_in, sorted_runs
from rthm_analysis.runs.reading import spec_words
from rthm_core.errors import InputError
from rthm_core.spec import apply, shipped_spec, write_spec

from .conftest import START, mcap_file
from .loop import recorded

PAPER = shipped_spec("paper")
SECOND = 1_000_000_000


def metadata(lost: int = 0, seconds: int = 3) -> str:
    summary = Summary("loop.mcap", [], START, START + seconds * SECOND, {"lost": str(lost), "twice": "0"})
    return summary.as_yaml(root=True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Runs: one that is whole, one that lost samples and has no report, one that has nothing but its spec."""
    out = tmp_path_factory.mktemp("out")
    for name in ("whole", "lossy", "dead"):
        (out / name / "log").mkdir(parents=True)
        (out / name / "spec.yaml").write_text(write_spec(apply(PAPER, {"timing.tau4": 0.03})))
    for name, lost in (("whole", 0), ("lossy", 7)):
        (out / name / "bag").mkdir()
        (out / name / "bag" / "metadata.yaml").write_text(metadata(lost, 3 + lost))
    mcap_file(out / "whole" / "bag" / "loop.mcap", recorded(apply(PAPER, {"timing.tau4": 0.03}), 3.0))
    write_report(out / "whole" / "bag", out / "whole" / "report.html")
    np.savez(out / "ideal.npz", t=[0.0, 20.0], plant_position=np.zeros((2, 1)))
    (out / "broken.npz").write_text("nothing")
    (out / "notes").mkdir()
    return out


def test_a_whole_run_has_its_date_length_outcome_and_error(folder: Path) -> None:
    runs = {run.name: run for run in runs_in(folder)}
    assert set(runs) == {"whole", "lossy", "dead", "ideal.npz", "broken.npz"}
    whole = runs["whole"]
    assert whole.begun == datetime.fromtimestamp(START * 1e-9)
    assert (whole.duration, whole.outcome, whole.problems) == (3.0, "stable", ())
    assert whole.spec == "paper, timing.tau4 0.03"
    assert 0.1 < whole.error["x1"] < 2.0


def test_what_is_missing_or_lost_is_a_problem(folder: Path) -> None:
    runs = {run.name: run for run in runs_in(folder)}
    assert "7 samples were lost on the way to the recorder." in runs["lossy"].problems
    assert runs["lossy"].outcome == runs["dead"].outcome == "no report"
    assert runs["dead"].problems[0] == "The recording is missing or incomplete."
    assert runs["ideal.npz"].duration == 20.0 and not runs["ideal.npz"].problems
    assert runs["broken.npz"].problems[0].startswith("It cannot be read")


def test_an_abort_is_told_in_its_own_words(tmp_path: Path) -> None:
    (tmp_path / "run" / "bag").mkdir(parents=True)
    (tmp_path / "run" / "report.html").write_text('<p class="abort">Aborted at 1 s: force &gt; 5 N.</p>')
    (run,) = runs_in(tmp_path)
    assert run.outcome == "aborted" and "Aborted at 1 s: force > 5 N." in run.problems


def test_runs_are_newest_first_and_sorted_as_asked(folder: Path) -> None:
    runs = runs_in(folder)
    assert [run.begun for run in runs] == sorted((run.begun for run in runs), reverse=True)
    assert [run.name for run in sorted_runs(runs, "length")][:2] == ["ideal.npz", "lossy"]
    assert sorted_runs(runs, "error")[0].name == "whole"
    assert [run.name for run in sorted_runs(runs, "name")] == sorted(run.name for run in runs)
    with pytest.raises(InputError, match="must be one of date, name"):
        sorted_runs(runs, "size")


def test_a_spec_is_told_by_the_shipped_one_that_it_is_most_like() -> None:
    assert spec_words(PAPER) == "paper"
    many = apply(PAPER, {f"timing.tau{k}": 0.001 * k + 0.0001 for k in (1, 2, 3, 4)})
    assert spec_words(many) == "like paper, 4 entries changed"


def test_the_page_of_an_index_links_to_the_reports(folder: Path, tmp_path: Path) -> None:
    write_runs(runs_in(folder), folder, folder / "index.html")
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert '<a href="whole/report.html">whole</a>' in page
    assert "7 samples were lost" in page


def test_an_empty_folder_has_no_runs(tmp_path: Path) -> None:
    assert runs_in(tmp_path) == []
    with pytest.raises(InputError, match="is not a folder of runs"):
        runs_in(tmp_path / "none")
    assert np.isnan(Run("a", tmp_path, "", datetime.now(), 1.0, "stable").worst)
