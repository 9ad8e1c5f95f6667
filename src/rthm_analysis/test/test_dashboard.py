"""What the page of a running test shows, from the messages of a test."""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np
import pytest

from rthm_analysis.dashboard import TOPICS, Facts, RunningTest, Trace
from rthm_analysis.energy import energy_of
from rthm_analysis.outcome import IdealComparison
from rthm_analysis.recording import read_recording
from rthm_analysis.timing import timing_of
from rthm_core.engine import simulate, simulate_blocks
from rthm_core.events import Abort, write_abort, write_event
from rthm_core.spec import LimitsSpec, apply, shipped_spec

from .conftest import START, Message, joint_state, mcap_file
from .loop import recorded

SPEC = shipped_spec("paper")
LIMITED = SPEC.model_copy(update={"limits": LimitsSpec(command=1.0, rate=5.0, force=50.0, stale=0.05)})


@pytest.fixture(scope="module")
def messages() -> list[Message]:
    return sorted(recorded(SPEC, 3.0), key=lambda message: message[1])


def looks(test: RunningTest, messages: list[Message], every_ns: int = 100_000_000) -> Iterator[dict]:
    """What is shown, ten times a second while the messages of a test come."""
    due = START + every_ns
    for topic, at, _, payload in messages:
        while at > due:
            yield test.look()
            due += every_ns
        if topic.removeprefix("/rthm/") in TOPICS:
            test.take(topic.removeprefix("/rthm/"), payload)
    yield test.look()


def watched(messages: list[Message], spec=SPEC, **facts) -> tuple[RunningTest, dict]:
    test = RunningTest(spec)
    test.learn(Facts(START, **facts))
    *_, last = looks(test, messages)
    return test, last


def columns(test: RunningTest) -> dict[str, np.ndarray]:
    rows = np.array(test.motion.after(0), dtype=float)
    return dict(zip(test.layout()["columns"], rows.T, strict=True))


def test_rows_are_the_motion_and_the_forces_of_the_test_and_the_ideal_motion(messages) -> None:
    shown = columns(watched(messages)[0])
    hybrid, ideal = (simulate(SPEC, 3.0, 0.02, system) for system in ("hybrid", "ideal"))
    count = len(shown["t"])
    assert count == 148  # up to 50 ms behind the newest sample
    assert np.allclose(shown["t"], 0.02 * np.arange(count))
    assert np.allclose(shown["x1.ideal"], ideal.plant_position[:count, 0], atol=1e-7)
    # What is held between two samples is as old as a period of its clock.
    assert (
        np.abs(shown["x1"] - hybrid.plant_position[:count, 0]).max()
        < 0.0012 * np.abs(hybrid.plant_velocity).max()
    )
    assert np.abs(shown["a1.reference"] - hybrid.force_reference[:count, 0]).max() < 0.7
    assert np.corrcoef(shown["a1.force"], hybrid.actuator_force[:count, 0])[0, 1] > 0.999


def test_the_error_so_far_is_that_of_the_verdict(messages) -> None:
    comparison = IdealComparison(SPEC, 2.94, 0.02)
    for block in simulate_blocks(SPEC, 2.94, 0.02, energies=False):
        comparison.add(block)
    verdict = comparison.errors()["x1"]
    (error,) = watched(messages)[1]["errors"]
    assert error["dof"] == "x1"
    assert error["nrmse"] == pytest.approx(verdict.nrmse, rel=0.01)
    assert error["max"] == pytest.approx(verdict.largest, rel=0.01)


def test_where_samples_were_not_heard_there_is_a_gap_and_no_error(messages) -> None:
    def heard(message: Message) -> bool:
        return message[0] != "/rthm/plant/state" or not 1.0 < (message[1] - START) * 1e-9 < 1.5

    test, last = watched([message for message in messages if heard(message)])
    shown = columns(test)
    gap = (shown["t"] > 1.001) & (shown["t"] < 1.5)
    assert np.isnan(shown["x1"][gap]).all()
    assert np.isfinite(shown["x1"][~gap]).all()
    assert np.isfinite(shown["x2"]).all()
    rows = ~gap
    error = (shown["x1"] - shown["x1.ideal"])[rows]
    rms = np.sqrt(np.mean(error**2) / np.mean(shown["x1.ideal"][rows] ** 2))
    assert last["errors"][0]["nrmse"] == pytest.approx(rms, rel=1e-4)


def test_who_joins_late_is_shown_the_ideal_motion_if_the_start_is_known(messages) -> None:
    late = [message for message in messages if message[1] >= START + 10**9]
    test, _ = watched(late)
    assert columns(test)["t"][0] == pytest.approx(1.0, abs=0.021)
    assert np.isfinite(columns(test)["x1.ideal"]).all()
    test, last = watched(late, whole=False)
    assert not np.isfinite(columns(test)["x1.ideal"]).any()
    assert last["no_ideal"] == "the start of the test was not heard"
    assert last["errors"] == [{"dof": "x1", "nrmse": None, "max": 0.0}]


def test_ages_are_those_of_the_recording_and_lie_within_the_schedule(messages, tmp_path) -> None:
    timing = timing_of(read_recording(mcap_file(tmp_path / "x.mcap", messages)), SPEC)
    for link in watched(messages)[1]["links"]:
        assert link["delay"] <= link["mean"] <= link["max"] <= link["worst"] <= link["oldest"]
        assert link["worst"] == pytest.approx(timing.links[link["name"]].age.max(), rel=1e-6)
        assert link["delay"] == pytest.approx(getattr(SPEC.timing, link["name"]))


def test_energies_are_shown_as_they_were_told(messages, tmp_path) -> None:
    whole = energy_of(read_recording(mcap_file(tmp_path / "x.mcap", messages)), SPEC)
    names = ["E_num", "E_ff", "E_fx", "E_err", "E_damping", "E_load", "E_effects", "E_total"]
    told = []
    for tenth in range(1, 26):
        row = int(np.searchsorted(whole.t, 0.1 * tenth - 1e-7))
        terms = whole.as_dict()
        effort = [terms[name][row] for name in names]
        told.append(joint_state("/rthm/energy", START + tenth * 10**8, names, effort=effort))
    test, last = watched(sorted([*messages, *told], key=lambda message: message[1]))
    rows = np.array(test.energy.after(0), dtype=float)
    assert np.allclose(rows[:, 0], 0.1 * np.arange(1, 26))
    assert last["energy"]["E_fx"] == pytest.approx(whole.as_dict()["E_fx"][row], rel=1e-6)
    assert np.allclose(rows[-1, 1:], list(last["energy"].values()), rtol=1e-6)


def test_the_reading_of_every_limit_is_that_of_the_test(messages, tmp_path) -> None:
    recording = read_recording(mcap_file(tmp_path / "x.mcap", messages))
    _, last = watched(messages, LIMITED)
    limits = {limit["name"]: limit for limit in last["limits"]}
    command = recording.tables["actuator/command"]
    assert set(limits) == {"command", "rate", "force", "age", "command_age"}
    assert limits["command"]["peak"] == pytest.approx(np.abs(command.position).max())
    assert limits["command"]["now"] < limits["command"]["peak"]
    steps = np.abs(np.diff(command.position[:, 0])) / np.diff(command.stamp_ns * 1e-9)
    assert limits["rate"]["peak"] == pytest.approx(steps.max(), rel=1e-4)
    assert limits["force"]["peak"] == pytest.approx(np.abs(command.effort).max())
    assert limits["age"]["peak"] == pytest.approx(SPEC.timing.tau3, rel=1e-6)
    assert limits["command_age"] | {"now": 0} == {
        "name": "command_age",
        "now": 0,
        "peak": 0.01,
        "allowed": 0.05,
        "unit": "s",
    }


def test_beside_a_machine_limits_have_their_defaults() -> None:
    machine = apply(LIMITED, {"limits.ramp": 1.0})
    test = RunningTest(machine)
    assert "step" not in {limit["name"] for limit in test.look()["limits"]}
    test.learn(Facts(START, hardware=True))
    assert {limit["name"]: limit["allowed"] for limit in test.look()["limits"]}["step"] == pytest.approx(
        0.012
    )


def test_a_test_starts_runs_is_aborted_and_ends_in_words(messages) -> None:
    test = RunningTest(SPEC)
    assert test.look()["state"] == "starting"
    test.learn(Facts(START, duration=3.0))
    assert test.look()["state"] == "starting"
    *_, last = looks(test, messages)
    assert (last["state"], last["words"]) == ("running", "The test is running.")
    assert last["at"] == pytest.approx(3.0, abs=0.002)
    test.end()
    assert test.look()["words"] == "The test is over."
    test.told.note_event(write_abort(Abort(2.5, "step", 0.3, 0.012, "x1 stepped by 0.3 m")))
    test.told.note_event(write_abort(Abort(2.6, "node", None, None, "a later one")))
    test.told.note_event(write_event("rest", at=3.1))
    last = test.look()
    assert last["state"] == "aborted"
    assert last["words"] == "Aborted at 2.500 s: x1 stepped by 0.3 m. The motors are at rest."
    assert [event["words"] for event in last["events"]] == [
        "Aborted: x1 stepped by 0.3 m",
        "The motors are at rest.",
    ]


def test_missed_ticks_and_losses_are_those_that_nodes_tell(messages) -> None:
    test, _ = watched(messages)
    test.told.note_status(
        "/rthm/actuator: loop",
        {"Td3 missed deadlines": "4", "tau1 late": "2", "tau1 lost": "1", "real-time priority": "0"},
    )
    test.told.note_status("/rthm/actuator: safety monitor", {"Td3 missed deadlines": "9"})
    last = test.look()
    assert last["clocks"] == [{"name": "Td3", "missed": 4}]
    assert last["without_priority"] == ["actuator"]
    assert (last["links"][0]["late"], last["links"][0]["lost"], last["links"][1]["lost"]) == (2, 1, None)


def test_an_unstable_loop_and_text_that_is_no_event_are_shown_as_well() -> None:
    wild = apply(SPEC, {"timing.tau4": 0.2})
    test, last = watched(sorted(recorded(wild, 3.0), key=lambda message: message[1]), wild)
    test.told.note_event("}{")
    test.take("plant/state", b"nonsense")
    text = json.dumps([last, test.look(), test.motion.after(0), test.layout()], allow_nan=False)
    assert json.loads(text)[0]["state"] == "running"


def test_another_start_is_another_test(messages) -> None:
    test, _ = watched(messages)
    test.learn(Facts(START + 10**12))
    assert test.look()["state"] == "starting"


def test_a_trace_gives_what_is_new_to_everybody_who_asks() -> None:
    trace = Trace(3)
    trace.extend([[float(k), np.nan] for k in range(5)])
    assert trace.after(0) == [[2.0, None], [3.0, None], [4.0, None]]
    assert trace.after(4) == [[4.0, None]]
    assert trace.after(trace.count) == []
