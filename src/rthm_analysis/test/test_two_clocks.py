"""A test over hosts whose clocks differ, recorded with what was measured of them: diagnosed, and repeated."""

from __future__ import annotations

import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.diagnosis import diagnose
from rthm_analysis.diagnosis.links import diagnose_links
from rthm_analysis.energy import energy_of
from rthm_analysis.recording import Recording, read_recording
from rthm_analysis.recording.synchronised import synchronised
from rthm_analysis.timing import RecordedSchedule, timing_of
from rthm_core.clock import NS
from rthm_core.engine import simulate
from rthm_core.spec import Spec, shipped_spec

from .conftest import START, Message, joint_state, mcap_file
from .loop import recorded

SPEC = shipped_spec()
NOISY = shipped_spec("paper_noisy")
"""The same test with real sensors: without noise, a diagnosis sees what a microsecond does."""
SECONDS = 12.0
UNSURE = 1e-4
"""Uncertainty of each comparison of clocks, s; the offsets that are told are off by up to this."""

TAU = {"tau1": 0.004, "tau2": 0.008, "tau3": 0.012, "tau4": 0.010}
HOLD = {"tau1": 0.0004, "tau2": 0.0004}
"""Median time that a sample waits for the tick at which it is used, s: Td1 divides neither of the delays."""

CLOCKS = {"3 ms ahead": (0.003, 0.0), "drifting 500 ppm": (0.001, 500e-6), "behind": (-0.0021, 0.0)}
"""Lead of the plant's clock at the start, s, and its growth, s/s."""
ALWAYS = "drifting 500 ppm"
"""The clock of every run of the tests; the others take long."""

PLANTS = {"/rthm/plant/state": (4,), "/rthm/links/tau1": (20,), "/rthm/links/tau2": (20,),
          "/rthm/links/tau4": (4,)}  # fmt: skip
"""Where messages have stamps of the plant's clock, bytes."""


def by_the_plants_clock(message: Message, lead: tuple[float, float]) -> Message:
    """Message with stamps as a plant makes them whose clock has this lead."""
    topic, received, kind, data = message
    bytes_ = bytearray(data)
    for place in PLANTS.get(topic, ()):
        seconds, ns = struct.unpack_from("<iI", bytes_, place)
        at = seconds * NS + ns
        at += round((lead[0] + lead[1] * (at - START) / NS) * NS)
        struct.pack_into("<iI", bytes_, place, *divmod(at, NS))
    return topic, received, kind, bytes(bytes_)


def compared(lead: tuple[float, float]) -> list[Message]:
    """Messages on the clock of the plant, ten times a second."""
    random, messages = np.random.default_rng(1), []
    for at in np.arange(-2.0, SECONDS + 1.0, 0.1):
        told = lead[0] + lead[1] * at + random.uniform(-0.9, 0.9) * UNSURE
        stamp = START + round(at * NS)
        messages.append(joint_state("/rthm/clocks", stamp, ("plant",), (told,), (), (UNSURE,)))
    return messages


@pytest.fixture(scope="module")
def messages() -> list[Message]:
    return recorded(SPEC, SECONDS)


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(lead, id=name, marks=[] if name == ALWAYS else [pytest.mark.long])
        for name, lead in CLOCKS.items()
    ],
)
def lead(request: pytest.FixtureRequest) -> tuple[float, float]:
    return request.param


@pytest.fixture(scope="module")
def stamped_wrong(
    messages: list[Message], lead: tuple[float, float], tmp_path_factory: pytest.TempPathFactory
) -> Recording:
    """A test as specified, whose plant has the wrong stamps."""
    shifted = [by_the_plants_clock(message, lead) for message in messages]
    return read_recording(mcap_file(tmp_path_factory.mktemp("a") / "x.mcap", shifted + compared(lead)))


@pytest.fixture(scope="module")
def run_wrong(
    messages: list[Message], lead: tuple[float, float], tmp_path_factory: pytest.TempPathFactory
) -> Recording:
    """A test over delays that are not as specified, since the plant's part waited by its own clock.

    Its stamps are those of a perfect one: sample, delay and use are by clocks that all seem right.
    """
    return read_recording(mcap_file(tmp_path_factory.mktemp("b") / "x.mcap", messages + compared(lead)))


def as_recorded_error(recording: Recording, spec: Spec) -> float:
    """Largest difference, m, of the test simulated along its recorded delays from the recorded motion."""
    schedule = RecordedSchedule(spec, recording)
    run = simulate(spec, SECONDS - 0.1, schedule=schedule)
    rows = run.plant_position.shape[0]
    return float(np.abs(run.plant_position[:, 0] - recording.plant.position[:rows, 0]).max())


def test_wrong_stamps_are_put_right_for_everybody(stamped_wrong: Recording) -> None:
    for name, link in timing_of(stamped_wrong, SPEC).links.items():
        assert np.median(link.age) == pytest.approx(TAU[name] + HOLD.get(name, 0.0), abs=UNSURE)
        assert (link.late, link.lost) == (0, 0)
    speed = float(np.abs(stamped_wrong.plant.velocity[:, 0]).max())
    assert as_recorded_error(stamped_wrong, SPEC) < speed * UNSURE


def test_a_test_with_wrong_stamps_is_diagnosed_as_what_it_was(
    lead: tuple[float, float], tmp_path: Path
) -> None:
    shifted = [by_the_plants_clock(message, lead) for message in recorded(NOISY, SECONDS)]
    found = diagnose(read_recording(mcap_file(tmp_path / "x.mcap", shifted + compared(lead))), NOISY)
    assert (found.verdict, found.physics, found.faults) == ("match", (), ())


@pytest.mark.long
def test_without_what_was_measured_they_are_not(
    messages: list[Message], lead: tuple[float, float], tmp_path: Path
) -> None:
    shifted = [by_the_plants_clock(message, lead) for message in messages]
    seen = read_recording(mcap_file(tmp_path / "x.mcap", shifted))
    tau4 = timing_of(seen, SPEC).links["tau4"]
    assert np.median(tau4.age) - TAU["tau4"] == pytest.approx(lead[0] + lead[1] * SECONDS / 2, abs=UNSURE)
    assert "link.tau4" in {one.block for one in diagnose_links(seen, SPEC).physics}


def test_delays_by_wrong_clocks_are_told_right(run_wrong: Recording, lead: tuple[float, float]) -> None:
    """Samples of the plant are as much older as its clock is ahead, and commands that much younger."""
    middle = lead[0] + lead[1] * SECONDS / 2
    hidden = {"tau1": middle, "tau2": middle, "tau3": 0.0, "tau4": -middle}
    for name, link in timing_of(run_wrong, SPEC).links.items():
        wait = TAU[name] + HOLD.get(name, 0.0)
        assert np.median(link.age) == pytest.approx(wait + hidden[name], abs=UNSURE)
    found = diagnose_links(run_wrong, SPEC)
    offsets = {one.block: one.parameters["offset"] for one in found.physics}
    assert offsets.keys() == {"link.tau1", "link.tau2", "link.tau4"}
    for block, value in offsets.items():
        assert abs(value.value - hidden[block.removeprefix("link.")]) <= value.std == UNSURE
    assert as_recorded_error(run_wrong, SPEC) < 1e-9
    assert any("clock of plant" in note for note in found.notes)


def test_nothing_else_is_found_in_a_test_over_wrong_clocks(lead: tuple[float, float], tmp_path: Path) -> None:
    told = recorded(NOISY, SECONDS) + compared(lead)
    found = diagnose(read_recording(mcap_file(tmp_path / "x.mcap", told)), NOISY)
    assert found.verdict == "explained"
    assert {one.kind for one in found.physics} == {"clock_offset"}


def test_the_energy_balance_is_kept_on_one_clock(run_wrong: Recording, stamped_wrong: Recording) -> None:
    assert stamped_wrong.clocks.applied and synchronised(stamped_wrong) is stamped_wrong
    assert not run_wrong.clocks.applied
    seen = replace(run_wrong, clocks=replace(run_wrong.clocks, applied=True))
    right, wrong = (energy_of(one, SPEC).work["E_num"][-1] for one in (run_wrong, seen))
    assert abs(right - wrong) > 0.01 * abs(wrong)


def test_a_clock_that_was_measured_not_to_be_off_changes_nothing(
    messages: list[Message], tmp_path: Path
) -> None:
    plain = read_recording(mcap_file(tmp_path / "a.mcap", messages))
    told = read_recording(mcap_file(tmp_path / "b.mcap", messages + compared((0.0, 0.0))))
    assert not diagnose_links(told, SPEC).physics
    assert np.array_equal(told.plant.stamp_ns, plain.plant.stamp_ns)
