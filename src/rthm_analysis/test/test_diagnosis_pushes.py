"""A rig that somebody pushed for a moment, or whose sensors showed another motion for one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.faults.moments import Moment, without_moments
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.pushed import pushed
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence

from .known_load import SPEC, STIFFNESS, Force, nothing, recorded

BLOW = (20.0, 20.02)


def blow(t: float, x: float, v: float) -> float:
    return 10.0 if BLOW[0] <= t < BLOW[1] else 0.0


def stop(t: float, x: float, v: float) -> float:
    """Touched where the rig moves furthest alone."""
    return -2000.0 * max(x - 0.14, 0.0)


def softened(t: float, x: float, v: float) -> float:
    return 0.1 * STIFFNESS * x if t > BLOW[0] else 0.0


def strayed(evidence: Evidence) -> Evidence:
    """The same with a sensor that shows another motion for half a second."""
    inside = slice(5000, 5125)
    measured = evidence.measured.copy()
    measured[inside, 0] += 0.02 * np.hanning(125)
    return replace(evidence, measured=measured)


def found(evidence: Evidence) -> Physical:
    return diagnose_physical(evidence, SPEC, np.empty(0), lambda said: None)


def test_a_push_is_found_and_left_out() -> None:
    evidence = recorded(blow)
    (push,) = pushed(found(evidence))
    assert push.push is not None and push.push.depends_on == ("t",)
    assert push.push.interval == (push.begin, push.end)
    blow_in_all = float(np.trapezoid(push.push.force, push.push.at))
    assert blow_in_all == pytest.approx(10.0 * (BLOW[1] - BLOW[0]), rel=0.2)
    assert push.begin < BLOW[0] < BLOW[1] < push.end < push.begin + 3.0

    rest, faults = without_moments(evidence, [push])
    assert not faults, "it is of the rig's world, and no fault of the recording"
    before, behind = evidence.time < push.begin, evidence.time >= push.end
    assert rest.begins == (0, np.count_nonzero(before))
    np.testing.assert_array_equal(rest.time, evidence.time[before | behind])
    assert rest.trained == int(rest.stamps_ns.size * 2 / 3), "one recording, of which the last third confirms"

    again = found(rest)
    assert not again.selection.rounds, "no physics is made up for the push"
    values = {p.key: p.value for p in again.selection.base.model.parameters}
    assert values["plant.stiffness"] * 62.0 == pytest.approx(STIFFNESS, rel=1e-3)
    assert not pushed(again)


def test_what_a_sensor_shows_for_a_moment_is_no_push() -> None:
    evidence = strayed(recorded())
    (push,) = pushed(found(evidence))
    assert push.push is None and push.strayed == (Channel("position", "x1"),)

    rest, (fault,) = without_moments(evidence, [push])
    assert (fault.block, fault.kind, fault.channel) == ("sensor.position", "stray", "x1.position")
    assert rest.begins == (0,), "the motion goes on"
    inside = (evidence.time >= push.begin) & (evidence.time < push.end)
    np.testing.assert_array_equal(np.isnan(rest.measured[:, 0]), inside)
    assert not found(rest).selection.rounds


@pytest.mark.long
def test_what_comes_behind_a_push_at_the_end_is_left_out_with_it() -> None:
    evidence = recorded()
    end = float(evidence.time[-1])
    push = pushed(found(recorded(blow)))[0].push
    rest, _ = without_moments(evidence, [Moment(end - 1.0, end - 0.1, push)])
    assert rest.begins == (0,)
    assert rest.time[-1] < end - 1.0


def rubbing(t: float, x: float, v: float) -> float:
    """A seal that rubs for some periods of the motion."""
    return -2.0 * v if 12.0 < t < 17.0 else 0.0


@pytest.mark.parametrize(
    "force", [nothing, stop, *(pytest.param(one, marks=pytest.mark.long) for one in (softened, rubbing))]
)
def test_nothing_and_physics_are_no_push(force: Force) -> None:
    assert not pushed(found(recorded(force)))
