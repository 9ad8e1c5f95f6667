"""Wrong input ends with one sentence: what, its value, what is allowed, the way out; nothing is lost."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from rthm_bringup.cli.main import main
from rthm_core.spec import apply, shipped_spec, shipped_text, write_spec

TABLE = [
    # specs
    ("simulate binary.yaml {1s}", "this is not text in UTF-8, but must be a YAML file; give the path"),
    ("simulate tabs.yaml {1s}", "tabs.yaml: the text is not YAML at line 2", "correct it, or give the path"),
    (
        "simulate twice.yaml {1s}",
        "plant.mass is there twice, again at line",
        "must be there once; remove one",
    ),
    ("simulate folder {1s}", "folder: this is a folder, but must be a spec file; name the file in it"),
    ("simulate 'a folder' {1s}", "a folder: this is a folder, but must be a spec file"),
    ("simulate blank.yaml {1s}", "blank.yaml: the spec is empty; give a ROS parameter file, or a shipped"),
    (
        "simulate heavy.yaml {1s}",
        "plant.mass[0] is 1e+300, but must be a finite number in kg of a size up to",
    ),
    ("simulate early.yaml {1s}", "timing.tau4 is -0.01, but must be a finite number at least 0 and at most"),
    ("simulate words.yaml {1s}", "plant.mass[0] is '1.2 kg', but must be a finite number in kg; correct it"),
    ("simulate papr {1s}", "papr: there is no such file", "a shipped one's name: paper is one"),
    ("specs papr", "there is no shipped spec 'papr', only decay, friction, paper", "write paper"),
    ("stability decay", "the spec describes a plant alone, but this needs a whole loop; add the sections"),
    (
        "stability late.yaml",
        "samples are in transit at once; limits can be computed for at most",
        "shorten the delays, or judge only the spec itself: rthm stability --no-limits",
    ),
    (
        "run many.yaml --plant external",
        "20007 samples are in transit at once, but at most 3000 can be followed; shorten the delays or",
    ),
    # numbers
    (
        "simulate paper --duration nan --out x.npz",
        "duration nan is not allowed, it must be a positive number",
    ),
    ("simulate paper --duration 0 --out x.npz", "duration 0.0 is not allowed", "give one above zero"),
    ("simulate paper --duration -1 --out x.npz", "duration -1.0 is not allowed", "give one above zero"),
    ("simulate paper --duration 1e300 --out x.npz", "must be a finite number of seconds below 292 years"),
    (
        "simulate paper --duration 1e7 --sample 1e-6 --out x.npz",
        "A trajectory of 1e+13 rows needs 2.4 PB",
        "free; take a larger --sample, a shorter --duration or another disk",
    ),
    ("simulate paper {1s} --sample 0", "sample 0.0 is not allowed", "give a positive number of seconds"),
    ("simulate paper {1s} --sample nan", "sample nan is not allowed", "at least one nanosecond"),
    (
        "simulate paper {1s} --amplitude nan",
        "--amplitude is nan, but must be a number above 0; 1 is the whole",
    ),
    (
        "simulate paper {1s} --sensitivity plant.mas",
        "plant.mas is not a number of this spec; name one that it has",
    ),
    ("simulate paper {1s} --system idal", "'idal' is not one of 'hybrid', 'ideal', 'taylor'", "--help"),
    ("run --virtual --duration 1e9", "The duration is 1e+09 s, but must be from 0 to 1e6 s; choose another"),
    (
        "run --virtual --duration nan",
        "The duration is nan s, but must be from 0 to 1e6 s; choose another one",
    ),
    ("run --wait -1", "Invalid value for '--wait'", "greater than or equal to 0; see rthm run --help"),
    ("run --priority 200", "Invalid value for '--priority'", "less than or equal to 99; see rthm run --help"),
    ("response paper --omega 0", "omega is [0.0], but must be positive, finite frequencies in rad/s"),
    ("response paper --omega one", "the values 'one' are not understood, allowed is a:b:n", "correct them"),
    (
        "response paper --omega 1:2:0",
        "the values '1:2:0' are not understood, allowed is a:b:n (n values from a",
    ),
    ("sweep paper --set plant.mass", "'plant.mass' is not understood, allowed is key=a:b:n", "correct it"),
    ("sweep paper --set plant.mas=1:2:3", "plant.mas (given as 1.0) is not a key", "write mass"),
    (
        "sweep paper --set plant.mass=-2:-1:3",
        "plant.mass is [-2.0], but must be a symmetric, positive definite",
    ),
    ("sweep paper --set plant.mass=1:2:3 --duration -1", "--duration is -1.0, but must be from 0 (stability"),
    (
        "sweep paper --set plant.mass=1:2:3 --workers 0",
        "--workers is 0, but must be at least 1; leave it out",
    ),
    ("sweep paper --set plant.mass=1:2:3 --draw 0", "draw is 0, but must be from 1 to 10000000 loops"),
    ("sweep paper --set plant.mass=1:2:3 --out text", "text is a file, but must be a folder", "another name"),
    # names
    ("simlate", "No such command 'simlate'", "Did you mean 'simulate'", "see rthm --help"),
    ("effects coulom", "there is no effect 'coulom'; write coulomb_friction"),
    ("effects --effects folder", "folder cannot be loaded as effects", "must be the path of a Python file"),
    (
        "reproduce -o x --only figure99",
        "'figure99' is not a figure, allowed is one of figure02",
        "choose one",
    ),
    ("runs folder --sort size", "--sort is 'size', but must be one of date, name, spec", "give one of them"),
    ("run --namespace 'a b'", "The namespace is '/a b', but must be words of letters", "choose another one"),
    ("run --peers 999.1.1.1", "The peer '999.1.1.1' has no IPv4 address", "name another one"),
    ("stability paper --map timing.tau9=0:1:3 plant.mass=1:2:3", "timing.tau9 (given as 0.0)", "write tau4"),
    # recordings
    ("energy folder", "folder is a folder without .mcap or .db3 files: give that of a rosbag2 recording"),
    ("energy no_such", "no_such does not exist: give the folder of a rosbag2 recording"),
    (
        "timing text",
        "text holds no message that can be read: give a rosbag2 recording",
        "neither an MCAP nor",
    ),
    ("diagnose zero.mcap", "zero.mcap holds no message that can be read", "give a rosbag2 recording"),
    (
        "diagnose bag --spec paper",
        "bag has neither actuator/command nor forces of a1",
        "record actuator/command",
    ),
    ("diagnose bag --spec papr", "papr: there is no such file", "paper is one"),
    ("energy bare", "bare contains no spec; give one with --spec."),
    (
        "export bag -o table.xls",
        "table.xls ends in .xls, but one table is written as .csv",
        "name one of these",
    ),
    ("export bag -o table.csv --rate 0", "--rate is 0.0, but must be above 0 and up to 1e7 Hz", "correct it"),
    ("import words.csv -o x", "words.csv, line 3, column x: 'abc' is not a number; correct it"),
    ("import blank.csv -o x", "blank.csv has no rows; give a table with one row per sample"),
    ("import motion.csv -o x --map positon:x1=x --time t", "'positon:x1=x' must be ROLE:NAME=COLUMN"),
    (
        "import motion.csv -o x --map position:x1=x --time t --unit position=parsec",
        "'parsec', but must be one",
    ),
    ("import motion.csv -o x --map position:x1=x --time when", "motion.csv has no column 'when', but t, x"),
    # places
    (
        "simulate paper --duration 1 --out x.csv",
        "--out is x.csv, but a trajectory is written as .npz; name it",
    ),
    (
        "simulate paper --duration 1 --out no/x.npz",
        "no is not a folder, so x.npz cannot be written there; make it",
    ),
    ("simulate paper --duration 1 --out ''", "a trajectory is written as .npz; name it motion.npz"),
    (
        "stability paper --json no/x.json",
        "no is not a folder, so x.json cannot be written there; make it first",
    ),
    ("stability paper --json folder", "--json is 'folder', a folder, but must be a file; name one in it"),
    ("report bag -o folder", "folder cannot be written (is a directory); name a file"),
    (
        "report bag -o text/page.html",
        "text/page.html cannot be written",
        "name a place that you may write to",
    ),
    ("report bag -o /dev/full", "/dev/full cannot be written (no space left on device); make room, or name"),
    ("specs --json /dev/full", "/dev/full cannot be written (no space left on device); make room, or name"),
]


def status(monkeypatch: pytest.MonkeyPatch, line: str) -> int:
    import shlex

    words = shlex.split(line.replace("{1s}", "--duration 1 --out x.npz"))
    monkeypatch.setattr("sys.argv", ["rthm", *words])
    with pytest.raises(SystemExit) as left:
        main()
    return int(left.value.code or 0)


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with everything that the table names, and nothing that it may write."""
    folder = tmp_path_factory.mktemp("wrong")
    paper = shipped_text("paper")
    noise = np.random.default_rng(1).bytes(4000)
    (folder / "folder").mkdir()
    (folder / "a folder").mkdir()
    for name, text in {
        "tabs.yaml": "/**:\n\tros__parameters: {}\n",
        "many.yaml": write_spec(apply(shipped_spec("paper"), {"timing.tau4": 2.0, "timing.td3": 1e-4})),
        "twice.yaml": paper.replace("mass: [1.2]", "mass: [1.2]\n      mass: [1.3]", 1),
        "heavy.yaml": paper.replace("mass: [1.2]", "mass: [1.0e300]", 1),
        "words.yaml": paper.replace("mass: [1.2]", "mass: ['1.2 kg']", 1),
        "early.yaml": paper.replace("tau4: 0.010", "tau4: -0.010", 1),
        "late.yaml": write_spec(apply(shipped_spec("paper"), {"timing.tau4": 10.0})),
        "blank.yaml": "",
        "text": "no recording\n",
        "zero.mcap": "",
        "words.csv": "t,x\n0,1\n0.1,abc\n",
        "blank.csv": "",
        "motion.csv": "t,x\n" + "".join(f"{0.01 * k},{np.cos(0.1 * k):.9f}\n" for k in range(2000)),
    }.items():
        (folder / name).write_text(text)
    (folder / "binary.yaml").write_bytes(noise)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        how = "--map position:x1=x --time t"
        assert status(patch, f"import motion.csv -o bag {how} --spec decay") == 0
        assert status(patch, f"import motion.csv -o bare {how}") == 0
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    return {str(file): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


@pytest.mark.parametrize("row", TABLE, ids=[row[0] for row in TABLE])
def test_wrong_input_is_one_sentence_with_a_way_out(
    row: tuple[str, ...], place: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture
) -> None:
    monkeypatch.chdir(place)
    before = contents(place)
    capfd.readouterr()
    assert status(monkeypatch, row[0]) == 2
    said = capfd.readouterr().err
    assert said.startswith("rthm: ") and said.endswith(".\n") and said.count("\n") == 1, said
    assert all(part in said for part in row[1:]), said
    assert "Error" not in said.replace("ModuleNotFoundError", "") and "Traceback" not in said
    assert contents(place) == before


def test_a_recording_that_is_cut_at_a_quarter_says_so(
    place: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    whole = next((place / "bag").glob("*.mcap"))
    monkeypatch.chdir(tmp_path)
    Path("cut").mkdir()
    Path("cut/bag.mcap").write_bytes(whole.read_bytes()[: whole.stat().st_size // 4])
    for verb in ("energy cut", "timing cut", "report cut -o page.html", "export cut -o tables"):
        capsys.readouterr()
        assert status(monkeypatch, verb) == 0
        assert "bag.mcap is cut off" in capsys.readouterr().out, verb
    assert "is cut off" in Path("page.html").read_text(encoding="utf-8")


def test_a_delay_of_seconds_where_milliseconds_were_meant_is_told_before_the_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("late.yaml").write_text(write_spec(apply(shipped_spec("paper"), {"timing.tau1": 4.0})))
    assert status(monkeypatch, "simulate late.yaml --duration 1 --out a.npz") == 0
    told = capsys.readouterr()
    assert "warning: timing.tau1 is 4 s, 1.54 periods of the motion (2.6 s); write 0.004 if" in told.err
    assert "Delay margin not computed" in told.err


def test_a_real_machine_is_not_moved_with_a_delay_longer_than_its_motion(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("late.yaml").write_text(write_spec(apply(shipped_spec("paper"), {"timing.tau1": 4.0})))
    assert status(monkeypatch, "run late.yaml --plant external") == 2
    told = capsys.readouterr().err
    assert "The machine will not be moved" in told and len(told.splitlines()) == 1


def test_a_real_machine_is_not_moved_by_an_unstable_loop_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("unstable.yaml").write_text(write_spec(apply(shipped_spec("paper"), {"timing.tau2": 0.09})))
    assert status(monkeypatch, "run unstable.yaml --plant external") == 2
    assert capsys.readouterr().err == (
        "rthm: Unstable: a small motion doubles every 21.3 s. It is stable below 0.713 times its periods and "
        "delays, or with tau2 below 78 ms (now 90 ms). The machine will not be moved; change the delays, or "
        "pass --unstable to run it anyway.\n"
    )


def test_a_motion_without_bounds_is_told_in_words(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("unstable.yaml").write_text(write_spec(apply(shipped_spec("paper"), {"timing.tau2": 0.3})))
    command = "simulate unstable.yaml --duration 20000 --sample 1 --out a.npz"
    assert status(monkeypatch, f"{command} --system taylor") == 0
    told = capfd.readouterr()
    assert not told.err and "E_total    diverged" in told.out
    assert not any(word in told.out.split() for word in ("nan", "inf", "+nan", "-inf"))


@pytest.mark.parametrize("signalled", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_simulation_leaves_nothing(signalled: signal.Signals, tmp_path: Path) -> None:
    words = ["simulate", "paper", "--duration", "9e8", "--sample", "1000", "--out", "long.npz"]
    heard = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)  # what runs in the background may ignore it
    with subprocess.Popen(
        [sys.executable, "-m", "rthm_bringup", *words],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=heard,
    ) as running:
        try:
            deadline = time.monotonic() + 120.0
            while not list(tmp_path.glob("*/t")) and running.poll() is None and time.monotonic() < deadline:
                time.sleep(0.02)
            running.send_signal(signalled)
            assert "interrupted." in running.communicate(timeout=60.0)[1]
        finally:
            running.kill()
    assert running.returncode == 130
    assert list(tmp_path.iterdir()) == []
