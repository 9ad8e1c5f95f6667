"""A motor goes elsewhere than it was told where both its sensor and the force of its wire say so."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from rthm_analysis.diagnosis.physical.driven import is_driven_wrong, motors_read_wrong, wires_are_off
from rthm_analysis.diagnosis.replay.evidence import Channel

COUNT = 3200
RANDOM = np.random.default_rng(7)
WANDERS = 5.0 * np.sin(np.linspace(0.0, 9.0, COUNT))


def side(
    force: np.ndarray, motor: np.ndarray, retuned: np.ndarray | None = None, *, wanders: bool = False
) -> Any:
    """A physical side whose wire's force and motor have these errors over their noise."""
    spec = SimpleNamespace(actuator=SimpleNamespace(names=["a1"]))
    nominal, tuned = (
        SimpleNamespace(spec=spec, left=one) for one in (force, force if retuned is None else retuned)
    )
    evidence = SimpleNamespace(channels=(Channel("position", "x1"), Channel("force", "a1")))
    alone = SimpleNamespace(
        forces=[1], residual=lambda model: model.left, experiment=SimpleNamespace(evidence=evidence)
    )
    return SimpleNamespace(
        drives=[],
        spec=spec,
        nominal=SimpleNamespace(model=nominal),
        selection=SimpleNamespace(base=SimpleNamespace(model=tuned)),
        fitting=SimpleNamespace(wires_alone=alone),
        motor_left=motor[:, None] if motor.size else np.empty((COUNT, 0)),
        motor_wanders=wanders,
    )


def noise() -> np.ndarray:
    return RANDOM.normal(size=COUNT)


def test_a_motor_that_wanders_is_told_by_the_force_of_its_wire() -> None:
    assert is_driven_wrong(side(0.4 * WANDERS + noise(), 20.0 * WANDERS + noise()))


def test_a_sensor_of_the_motor_that_wanders_is_not_its_motion() -> None:
    assert not is_driven_wrong(side(noise(), 20.0 * WANDERS + noise()))


def test_what_the_sensor_of_a_motor_reads_beside_the_commands_is_told_and_noise_is_not() -> None:
    assert motors_read_wrong(side(noise(), 20.0 * WANDERS + noise()))
    assert not motors_read_wrong(side(noise(), 20.0 * WANDERS + noise(), wanders=True))
    assert not motors_read_wrong(side(0.4 * WANDERS + noise(), 20.0 * WANDERS + noise()))
    assert not motors_read_wrong(side(noise(), noise()))


def test_a_wire_that_is_off_by_itself_is_not_its_motor() -> None:
    other = side(np.cos(np.linspace(0.0, 60.0, COUNT)) * 5.0 + noise(), 20.0 * WANDERS + noise())
    assert wires_are_off(other) and not is_driven_wrong(other)


def test_a_motor_that_is_not_measured_is_not_blamed() -> None:
    assert not is_driven_wrong(side(WANDERS + noise(), np.empty(0)))


def test_a_wire_that_is_right_with_the_values_of_the_spec_is_right() -> None:
    assert not wires_are_off(side(noise(), noise(), retuned=WANDERS + noise()))
