"""A lag that a constant delay does better than is a late channel; a lag stays one."""

from __future__ import annotations

import pytest

from rthm_analysis.diagnosis.faults import mend
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.late_sensors import late_sensors, undecided
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_core.physical.side import first_command

from .faulty import PAPER, TD1, VELOCITY, having, hybrid, later


def found(evidence: Evidence) -> Physical:
    return diagnose_physical(evidence, PAPER, first_command(PAPER), lambda said: None)


def test_a_delay_of_one_sample_is_no_lag() -> None:
    clean = hybrid(noise=0.1)
    late = later(clean, VELOCITY, TD1 * 1e-9)
    physical = found(late)
    assert ("sensor.velocity", "lag") in [tried[0].label[:2] for tried in physical.selection.rounds]
    (one,) = late_sensors(physical)
    assert one.channel == Channel("velocity", "x1") and one.delay == pytest.approx(TD1 * 1e-9, rel=0.05)
    assert one.is_clear and not undecided([one])
    moved = mend(late, PAPER).moved_back({one.channel: one.delay})
    assert moved.moved and [fault.kind for fault in moved.faults] == ["channel_delay"]
    assert not found(moved.evidence).selection.rounds


def test_a_filter_stays_a_lag() -> None:
    physical = found(hybrid(having(PAPER, "sensor.velocity", "lag", time_constant=3e-3), noise=0.1))
    assert [tried[0].label[:2] for tried in physical.selection.rounds] == [("sensor.velocity", "lag")]
    (one,) = late_sensors(physical)
    assert not one.is_clear and not one.is_undecided


def test_where_the_motion_is_too_slow_both_are_told() -> None:
    (one,) = late_sensors(found(later(hybrid(), VELOCITY, TD1 * 1e-9)))
    (words,) = undecided([one])
    assert "may as well be a constant delay of 1.2 ms" in words
