"""Of a plant alone whose position and velocity were measured, each checks the sensor of the other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.faults import mend
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.readings import fast_noise
from rthm_analysis.diagnosis.search.candidates import sensor_starts
from rthm_analysis.diagnosis.signals import ahead

from .faulty import NOISE, PLAIN, POSITION, TD1, VELOCITY, changed, having, later, plain

LAG = 0.012
"""Time constant, s."""


def found(evidence: Evidence) -> list[tuple[str, ...]]:
    physical = diagnose_physical(evidence, PLAIN, np.empty(0), lambda said: None)
    return [tried[0].label[:2] for tried in physical.selection.rounds]


@pytest.mark.parametrize(("column", "block"), [(POSITION, "position"), (VELOCITY, "velocity")])
def test_a_sensor_that_reads_too_little_is_named(column: int, block: str) -> None:
    less = changed(plain(), column, lambda read: 0.93 * read)
    assert found(less) == [(f"sensor.{block}", "scale")]


@pytest.mark.parametrize("block", ["sensor.position", "sensor.velocity"])
def test_a_sensor_with_a_filter_is_named(block: str) -> None:
    assert found(plain(having(PLAIN, block, "lag", time_constant=LAG))) == [(block, "lag")]


@pytest.mark.parametrize(("column", "channel"), [(POSITION, "x1.position"), (VELOCITY, "x1.velocity")])
def test_the_signal_that_is_behind_the_other_is_late(column: int, channel: str) -> None:
    mended = mend(later(plain(), column, 0.018), PLAIN)
    (fault,) = mended.faults
    assert (fault.kind, fault.channel) == ("channel_delay", channel)
    assert fault.value == pytest.approx(0.018, abs=4e-4)


def test_a_signal_that_is_moved_keeps_its_noise() -> None:
    noise = np.random.default_rng(0).normal(size=20_000)
    assert fast_noise(ahead(noise, 3.5)[100:-100]) == pytest.approx(fast_noise(noise), rel=0.05)


def test_no_more_than_what_is_near_a_gap_is_lost() -> None:
    wave = np.sin(0.05 * np.arange(1000.0))
    wave[400:420] = np.nan
    moved = ahead(wave, 0.5)
    assert np.flatnonzero(np.isnan(moved)).tolist() == [*range(399, 420), 999]
    assert np.nanmax(np.abs(moved - np.sin(0.05 * (np.arange(1000.0) + 0.5)))) < 1e-3


@pytest.mark.parametrize("lag", [0.006, LAG])
def test_noise_that_passes_the_filter_of_its_sensor_is_no_physics(lag: float) -> None:
    pole = np.exp(-TD1 * 1e-9 / lag)

    def filtered(read: np.ndarray) -> np.ndarray:
        for i in range(1, read.size):
            read[i] = pole * read[i - 1] + (1.0 - pole) * read[i]
        return read

    seen = changed(plain(), VELOCITY, filtered)
    physical = diagnose_physical(seen, PLAIN, np.empty(0), lambda said: None)

    part = physical_part(physical)
    assert [(one.block, one.kind) for one in part.physics] == [("sensor.velocity", "lag")]
    assert not part.unexplained
    colour, passed = physical.noise.colours[VELOCITY], np.sqrt((1.0 - pole) / (1.0 + pole))
    assert colour.pole == pytest.approx(pole, abs=0.05)
    assert colour.level == pytest.approx(NOISE[VELOCITY] * passed, rel=0.1)


def test_a_position_alone_has_nothing_to_check_its_sensor() -> None:
    both = plain()
    alone = replace(both, channels=both.channels[:1], measured=both.measured[:, :1])
    assert not list(sensor_starts(alone, np.ones(1)))
