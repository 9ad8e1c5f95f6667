"""The spec of a recording can be given: where it has none, and in place of its own."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from rthm_bringup.cli.main import application
from rthm_core.spec import apply, shipped_spec, write_spec

VERBS = ("diagnose", "energy", "timing", "report", "export", "compare")


def run(line: str) -> int:
    return int(application()(line.split(), standalone_mode=False, prog_name="rthm") or 0)


@pytest.fixture
def bags(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the same swing as a bag with a spec and as one without, and a stiffer spec."""
    monkeypatch.chdir(tmp_path)
    rows = [f"{0.01 * k:.2f},{0.5 * math.cos(0.03 * k):.9f}" for k in range(400)]
    Path("decay.csv").write_text("\n".join(["t,x", *rows]) + "\n")
    stiffer = apply(shipped_spec("decay"), {"plant.stiffness": [20.0]})
    Path("stiffer.yaml").write_text(write_spec(stiffer))
    run("import decay.csv -o bare --map position:x1=x")
    run("import decay.csv -o bag --map position:x1=x --spec decay")
    return tmp_path


def energy_of(line: str) -> dict[str, list[float | None]]:
    assert run(f"{line} --json energy.json") == 0
    return json.loads(Path("energy.json").read_text())


@pytest.mark.usefixtures("bags")
def test_a_spec_that_is_given_stands_in_for_one_that_was_not_recorded() -> None:
    whole, given = energy_of("energy bag"), energy_of("energy bare --spec decay")
    assert given["E_total"] == whole["E_total"]
    assert not any("spec" in note for note in given["notes"])


@pytest.mark.usefixtures("bags")
def test_a_spec_that_is_given_counts_more_than_the_recorded_one() -> None:
    assert energy_of("energy bag --spec stiffer.yaml")["E_total"] != energy_of("energy bag")["E_total"]


def test_the_other_verbs_take_it_too(bags: Path) -> None:
    assert run("timing bare --spec decay") == 0
    assert run("report bare --spec decay --out page.html") == run("export bare --spec decay -o files") == 0
    assert run("compare bare bag --spec decay") == 0
    assert "<h2>Spec</h2>" in (bags / "page.html").read_text(encoding="utf-8")
    assert (bags / "files" / "spec.yaml").is_file()


def test_every_verb_that_reads_one_recording_has_the_option(capsys: pytest.CaptureFixture[str]) -> None:
    for verb in VERBS:
        run(f"{verb} --help")
        assert "--spec SPEC" in capsys.readouterr().out
