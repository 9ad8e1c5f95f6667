"""Of a plant alone whose position and velocity were measured, each checks the sensor of the other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.search.candidates import sensor_starts

from .faulty import PLAIN, POSITION, VELOCITY, changed, having, plain

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


def test_a_position_alone_has_nothing_to_check_its_sensor() -> None:
    both = plain()
    alone = replace(both, channels=both.channels[:1], measured=both.measured[:, :1])
    assert not list(sensor_starts(alone, np.ones(1)))
