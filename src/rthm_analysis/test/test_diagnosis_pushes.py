"""A rig that somebody pushed for a moment, or whose sensors showed another motion for one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.faults.push import without_pushes
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.pushed import pushed
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.evidence import Evidence

from .known_load import SAMPLES, SPEC, STIFFNESS, TIME, Force, nothing, recorded

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
    assert not push.off
    assert TIME[push.first] < BLOW[0] < BLOW[1] < TIME[push.end - 1] < TIME[push.first] + 3.0

    rest, (fault,) = without_pushes(evidence, [push])
    assert (fault.block, fault.kind) == ("plant", "unrecorded_push")
    assert fault.interval == pytest.approx((TIME[push.first], TIME[push.end - 1]))
    assert rest.begins == (0, push.first)
    assert rest.stamps_ns.size == SAMPLES - (push.end - push.first)
    assert rest.trained == int(rest.stamps_ns.size * 2 / 3), "one recording, of which the last third confirms"

    again = found(rest)
    assert not again.selection.rounds, "no physics is made up for the push"
    values = {p.key: p.value for p in again.selection.base.model.parameters}
    assert values["plant.stiffness"] * 62.0 == pytest.approx(STIFFNESS, rel=1e-3)
    assert not pushed(again)


def test_what_a_sensor_shows_for_a_moment_is_no_push() -> None:
    evidence = strayed(recorded())
    (push,) = pushed(found(evidence))
    assert push.off

    rest, (fault,) = without_pushes(evidence, [push])
    assert (fault.block, fault.kind) == ("sensor.position", "stray")
    assert rest.begins == (0,), "the motion goes on"
    assert np.isnan(rest.measured[push.first : push.end]).all()
    assert not found(rest).selection.rounds


@pytest.mark.parametrize("force", [nothing, stop, softened])
def test_nothing_and_physics_are_no_push(force: Force) -> None:
    assert not pushed(found(recorded(force)))
