"""Zeros that differ from recording to recording are numbers of each, and no physics of the rig."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.joining import joined
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.physical.own_zeros import diagnose_several, differing
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.joint import one_after_the_other
from rthm_analysis.diagnosis.result import Diagnosis
from rthm_core.spec import Spec, apply

from .plain import STIFFNESS, Law, plant, recorded

NO_MOTORS = np.empty(0)
LEVELS = (0.2, 0.6, 0.4)
NAMES = ["low", "high", "middle"]
BIASES = (-0.003, 0.002, 0.0)
FORCES = (0.05, -0.02, 0.0)


def free(t: float, x: float, v: float) -> float:
    return 0.0


def recordings(law: Law = free, levels: Sequence[float] = LEVELS, start: float = 0.0) -> list[Evidence]:
    return [recorded(law, duration=12.0, seed=i, force=force, start=start) for i, force in enumerate(levels)]


def together(evidences: Sequence[Evidence]) -> Evidence:
    return one_after_the_other(evidences, NAMES[: len(evidences)], NO_MOTORS)


def biased(one: Evidence, by: float) -> Evidence:
    return replace(one, measured=one.measured + np.array([by, 0.0]))


def off(one: Evidence, by: float) -> Evidence:
    """With a load cell that reads too much."""
    return replace(one, load=one.load + by)


def diagnosed(evidence: Evidence, spec: Spec) -> Diagnosis:
    return joined([physical_part(diagnose_several(evidence, spec, NO_MOTORS, lambda said: None))], spec)


def each(found: Diagnosis, signal: str) -> list[tuple[float, float]]:
    return [(one.offsets[signal].value, one.offsets[signal].std) for one in found.recordings]


def test_zeros_of_a_position_that_differ_are_told_and_are_no_physics() -> None:
    evidence = together([biased(one, by) for one, by in zip(recordings(), BIASES, strict=True)])
    found = diagnosed(evidence, plant())
    assert found.verdict == "explained" and found.located == ("sensor.position",)
    assert not (found.physics or found.described or found.unexplained or found.retuned)
    for (value, std), true in zip(each(found, "x1"), BIASES, strict=True):
        assert abs(value - true) < 4.0 * std < 4e-4
    (fault,) = found.faults
    assert fault.kind == "offset" and fault.channel == "x1.position"
    assert "in low" in fault.words and "in middle" in fault.words and "no physics" in fault.words
    assert "do not tell it from a constant force on x1" in fault.words
    assert found.as_dict()["recordings"][0]["offsets"]["x1"]["unit"] == "m"
    for one in found.recordings:
        assert one.nrmse["x1"]["explained"] < 1.3 * one.nrmse["x1"]["noise_floor"]


def test_beside_a_linear_spring_an_offset_of_a_load_cell_is_said_to_be_the_same() -> None:
    evidence = together([off(one, by) for one, by in zip(recordings(), FORCES, strict=True)])
    found = diagnosed(evidence, plant())
    assert not (found.physics or found.described or found.unexplained)
    for (value, std), true in zip(each(found, "x1"), FORCES, strict=True):
        assert abs(value + true / STIFFNESS) < 4.0 * std
    assert (
        "do not tell it from a constant force on x1, or an offset of its load cell" in found.faults[0].words
    )


def test_a_spring_that_stiffens_tells_a_force_from_a_zero() -> None:
    law, force = (lambda t, x, v: -300.0 * x**3), "-a * x**3"
    stiff = {"block": "plant", "kind": "formula", "force": force, "a": 300.0}
    spec = apply(plant(), {"effects": ["stiff"], "stiff": stiff})
    levels = (0.6, 1.2, 0.9)
    loads = together([off(one, 4.0 * by) for one, by in zip(recordings(law, levels), FORCES, strict=True)])
    zeros = together([biased(one, 2.0 * by) for one, by in zip(recordings(law, levels), BIASES, strict=True)])
    for evidence, forces in ((loads, True), (zeros, False)):
        best, other = sorted(differing(evidence, spec, NO_MOTORS), key=lambda one: one.left)
        assert best.of_forces == forces and best.left < 1.1 * best.expected < 0.2 * other.left
    found = diagnosed(loads, spec)
    for (value, std), true in zip(each(found, "load_x1"), FORCES, strict=True):
        assert abs(value - 4.0 * true) < 4.0 * std < 2e-3
    assert found.verdict == "explained" and not (found.physics or found.described or found.unexplained)
    assert found.faults[0].channel == "x1.effort" and "load cell" in found.faults[0].words
    assert set(found.recordings[0].offsets) == {"load_x1"}


@pytest.mark.long
def test_physics_is_found_beside_zeros_that_differ() -> None:
    """At first it hides them: its share of what is left is the larger."""
    some = recordings(lambda t, x, v: -40.0 * x**3, (0.3, 0.6, 0.5))
    evidence = together([biased(one, by) for one, by in zip(some, BIASES, strict=True)])
    found = diagnosed(evidence, plant(stiffness=0.05))
    assert found.verdict == "explained" and [one.kind for one in found.physics] == ["cubic_stiffness"]
    coefficient = found.physics[0].parameters["coefficient"]
    assert abs(coefficient.value - 40.0) < 4.0 * coefficient.std < 2.0
    assert [one.channel for one in found.faults] == ["x1.position"]
    for (value, std), true in zip(each(found, "x1"), BIASES, strict=True):
        assert abs(value - true) < 4.0 * std < 4e-4


def test_what_bends_a_motion_to_one_side_is_no_zero() -> None:
    """Its mean grows with the level, and more than its mean shows."""
    found = diagnosed(together(recordings(lambda t, x, v: -12.0 * x**2)), plant())
    assert [one.kind for one in found.physics] == ["quadratic_stiffness"] and not found.faults


def test_a_force_that_all_recordings_share_is_physics_as_before() -> None:
    found = diagnosed(together(recordings(lambda t, x, v: 0.05)), plant())
    assert not found.faults and len(found.physics) == 1


def test_recordings_with_right_zeros_have_none() -> None:
    assert not differing(together(recordings()), plant(), NO_MOTORS)
