"""Tests over hosts whose clocks differ: measured, refused, or corrected."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest
from benchmarks.hosts import ADDRESSES, on

from rthm_analysis.recording import read_recording
from rthm_core.ros.wall import VARIABLE
from rthm_core.spec import LimitsSpec, shipped_spec, write_spec

pytestmark = [pytest.mark.graph, pytest.mark.usefixtures("nothing_left")]
NEAR = 0.0002
"""How well an offset is measured by the quickest exchange of a test, s, on a busy machine, too."""


def run(
    hosts: tuple[str, str],
    environment: dict[str, str],
    clock: str,
    *options: str | Path,
    spec: str | Path = "paper",
) -> tuple[int, dict, str]:
    """Lead a test whose numerical substructure is on a host with this clock; status, JSON and complaints."""
    words = [sys.executable, "-m", "rthm_bringup", "run", str(spec), "--external", "numerical", "--json", "-"]
    words += ["--peers", ADDRESSES[1], "--wait", "120", *map(str, options)]
    there = [sys.executable, "-m", "rthm_bringup", "node", "numerical", str(spec), "--peers", ADDRESSES[0]]
    with ExitStack() as ends:
        numerical = ends.enter_context(on(hosts[1], there, environment | {VARIABLE: clock}))
        ends.callback(numerical.terminate)
        leader = ends.enter_context(on(hosts[0], words, environment))
        told, complaints = leader.communicate(timeout=300)
    return leader.returncode, json.loads(told), complaints


def test_a_clock_that_is_3_ms_ahead_is_refused_before_anything_moves(
    hosts: tuple[str, str], environment: dict[str, str], tmp_path: Path
) -> None:
    status, told, _ = run(hosts, environment, "0.003", "--duration", "3", "--out", tmp_path / "out")
    assert status != 0
    host = told["hosts"]["numerical"]
    assert abs(host["offset"] - 0.003) <= host["uncertainty"] + 1e-5
    assert any(
        "the clock of numerical is" in words and "ahead of this host's" in words for words in told["problems"]
    )
    assert any("--allow-clock-offset" in words for words in told["problems"])
    assert not list((tmp_path / "out").glob("report.html"))


def host_latency(links: dict) -> float:
    """What a busy machine adds to a command from controller to plant, which are on one host here, s."""
    return abs(links["tau4"]["excess"]["p50"])


@pytest.mark.long
def test_a_clock_that_drifts_beyond_its_limit_ends_the_running_test(
    hosts: tuple[str, str], environment: dict[str, str], tmp_path: Path
) -> None:
    limit, drift, begun = 0.04, 500e-6, time.time()  # reached 80 s after the start of the processes
    file = tmp_path / "drifting.yaml"
    file.write_text(write_spec(shipped_spec().model_copy(update={"limits": LimitsSpec(clock=limit)})))
    options = ("--duration", "120", "--out", tmp_path / "out")
    status, told, complaints = run(hosts, environment, f"0.0 {drift!r} {begun!r}", *options, spec=file)
    abort = told["abort"]
    assert (status, abort and abort["limit"]) == (3, "clock"), (told, complaints)
    assert abort["value"] > abort["allowed"] == limit
    assert abort["words"].startswith("the clock of numerical is")
    recording = read_recording(told["bag"])
    assert recording.abort is not None
    assert recording.abort.words == abort["words"]
    crossed = (begun + limit / drift) - recording.start_ns / 1e9
    assert crossed - 0.1 < abort["at"] < crossed + 5.0


@pytest.mark.parametrize("drift", [pytest.param(0.0, marks=pytest.mark.long), 500e-6])
def test_a_clock_that_may_be_off_is_measured_and_the_delays_are_told_right(
    hosts: tuple[str, str], environment: dict[str, str], tmp_path: Path, drift: float
) -> None:
    begun, duration = time.time(), 5.0
    clock = f"0.003 {drift!r} {begun!r}"
    options = ("--duration", str(duration), "--allow-clock-offset", "--out", tmp_path / "out")
    _, told, complaints = run(hosts, environment, clock, *options)
    recording = read_recording(told["bag"])
    measured = recording.clocks.nodes["numerical"]
    true = 0.003 + drift * (measured.at_ns / 1e9 - begun)
    assert np.all(np.abs(measured.offset - true) <= measured.uncertainty + 1e-5), complaints
    quickest = int(np.argmin(measured.uncertainty))
    assert abs(measured.offset[quickest] - true[quickest]) < NEAR, complaints
    timing = subprocess.run(
        [sys.executable, "-m", "rthm_bringup", "timing", told["bag"], "--json", "-"],
        env=environment, capture_output=True, text=True, check=True,
    )  # fmt: skip
    links = json.loads(timing.stdout)["links"]
    middle = recording.start_ns / 1e9 + duration / 2  # clocks are compared before the start, too
    ahead = 0.003 + drift * (middle - begun)
    near = 1e-3 + host_latency(links)
    assert links["tau3"]["excess"]["p50"] == pytest.approx(ahead, abs=near)
    if ahead < 0.006:  # further ahead, samples that are due have not been made yet
        assert links["tau2"]["excess_undisturbed"]["p50"] == pytest.approx(-ahead, abs=near)


@pytest.mark.long
@pytest.mark.parametrize("hosts", [3], indirect=True)
def test_on_three_hosts_a_clock_that_is_off_and_one_that_drifts_are_measured(
    hosts: tuple[str, str, str], environment: dict[str, str], tmp_path: Path
) -> None:
    """The leader with its controller, the plant 3 ms ahead, and a numerical substructure that drifts."""
    drift, begun = 100e-6, time.time()
    clocks = {"plant": "0.003", "numerical": f"0.0 {drift!r} {begun!r}"}
    leads = [sys.executable, "-m", "rthm_bringup", "run", "paper", "--external", "plant,numerical"]
    leads += ["--peers", ",".join(ADDRESSES[1:]), "--wait", "120", "--allow-clock-offset", "--json", "-"]
    leads += ["--duration", "5", "--out", str(tmp_path / "out")]
    with ExitStack() as ends:
        for (part, clock), host, other in zip(clocks.items(), hosts[1:], ADDRESSES[:0:-1], strict=True):
            words = [sys.executable, "-m", "rthm_bringup", "node", part, "paper"]
            words += ["--peers", f"{ADDRESSES[0]},{other}"]
            node = ends.enter_context(on(host, words, environment | {VARIABLE: clock}))
            ends.callback(node.terminate)
        leader = ends.enter_context(on(hosts[0], leads, environment))
        said, complaints = leader.communicate(timeout=300)
    told = json.loads(said)
    recording = read_recording(told["bag"])
    ahead = {}
    for part, measured in recording.clocks.nodes.items():
        true = 0.003 if part == "plant" else drift * (measured.at_ns / 1e9 - begun)
        quickest = int(np.argmin(measured.uncertainty))
        off = np.abs(measured.offset - true)
        assert np.all(off <= measured.uncertainty + 1e-5), (part, complaints)
        assert off[quickest] < NEAR, (part, complaints)
        ahead[part] = float(np.median(np.broadcast_to(true, measured.offset.shape)))
    assert set(ahead) == {"plant", "numerical"}
    links = told["links"]
    assert links["tau1"]["excess"]["p50"] == pytest.approx(ahead["plant"], abs=1e-3)
    assert links["tau3"]["excess"]["p50"] == pytest.approx(ahead["numerical"], abs=1e-3)
