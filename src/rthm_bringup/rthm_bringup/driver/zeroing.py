"""The zero of a rig, taken while it stands still: what its driver reads, raw, becomes what it subtracts."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_actuator.sensors import FORCE, Sensors
from rthm_bringup.driver.rest import Reading, readings
from rthm_bringup.interruption import held_back
from rthm_bringup.run.shared_memory import Caretaker
from rthm_bringup.run.stopped import StoppedError
from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.limits import kept_limits
from rthm_core.spec import apply
from rthm_core.topics import PLANT_STATE

if TYPE_CHECKING:
    from sensor_msgs.msg import JointState

    from rthm_bringup.run.conductor_node import Conductor
    from rthm_bringup.run.environment import Network
    from rthm_core.spec import Spec

FEWEST_TO_ZERO = 100
"""Samples without which nothing is said."""


@contextmanager
def at_rig(network: Network) -> Iterator[Conductor]:
    """Be the leader of a rig, as a run is, without a test."""
    with TemporaryDirectory() as log, Caretaker():
        os.environ.update(network.variables() | {"ROS_LOG_DIR": log})
        from rthm_bringup.run.conductor_node import Conductor  # ROS reads its environment when imported

        with (
            held_back() as interruption,
            Conductor(lambda: None, network.domain, network.namespace, interruption.obey) as conductor,
        ):
            yield conductor


def rest_of(conductor: Conductor, spec: Spec, seconds: float, patience: float) -> list[Reading]:
    """What all sensors read for some seconds.

    Raises
    ------
    InputError
        When nobody publishes ``plant/state``, or not what the spec has.
    """
    loop, sensors = spec.loop(), Sensors(spec)
    wanted, period = [*loop.plant.dofs, *loop.actuator.names], loop.timing.td1
    span = max(seconds, FEWEST_TO_ZERO * period)
    with conductor.samples(PLANT_STATE) as found:
        _wait(conductor, lambda: bool(found), patience, "Nobody publishes plant/state; start the driver.")
        if list(found[-1].name) != wanted:
            raise InputError(
                f"plant/state has the names {list(found[-1].name)}, but the spec has {wanted}; change one."
            )
        sizes = {len(array) for array in (found[-1].position, found[-1].velocity, found[-1].effort)}
        if sizes != {len(wanted)}:
            raise InputError(
                "plant/state does not have one value for each name; rthm check-driver shows the details."
            )
        found.clear()
        _wait(conductor, lambda: _span(found) >= span, 10.0 * span + 10.0, "The driver stopped publishing.")
    n = loop.plant.n
    rows = [[*one.position[:n], *one.velocity[:n], *one.position[n:], *one.effort[n:]] for one in found]
    start = kept_limits(spec, hardware=True).start
    assert start is not None
    return readings(sensors.channels, np.array(rows, dtype=float), (start[0], start[1]))


def zeroed(spec: Spec, found: list[Reading], kinds: frozenset[str]) -> Spec:
    """Return the spec with a zero of these kinds of sensor; others keep theirs, unmeasured ones have none.

    A load cell is taken to pull nothing: a pretension that was measured before is forgotten.
    """
    changes: dict[str, Any] = {}
    for kind in kinds:
        values = [one.mean for one in found if one.channel.kind == kind]
        changes[f"zero.{kind}"] = values if values and np.isfinite(values).all() else None
    if FORCE in kinds:
        changes["zero.tension"] = None
    return apply(spec, changes)


def slack_zero(spec: Spec) -> Spec:
    """Return the spec as it was before its wires were tightened.

    Raises
    ------
    InputError
        If it has no pretension to approach, or the load cells have no zero.
    """
    if not any(spec.loop().actuator.pretension):
        raise InputError(
            "actuator.pretension is 0, so there is nothing to tighten to; give a pretension above 0."
        )
    if spec.zero is None or spec.zero.force is None:
        raise InputError("zero.force is missing, but must be taken with slack wires first; run rthm zero.")
    tension = spec.zero.tension or (0.0,) * len(spec.zero.force)
    force = [both - pull for both, pull in zip(spec.zero.force, tension, strict=True)]
    return apply(spec, {"zero.force": force, "zero.tension": None})


def tensioned(spec: Spec, found: list[Reading]) -> Spec:
    """Return the spec with the tension that the load cells read now as the pretension of its wires."""
    tension = [max(one.mean, 0.0) for one in found if one.channel.kind == FORCE]
    before = (spec.zero.force if spec.zero else None) or (0.0,) * len(tension)
    force = [old + new for old, new in zip(before, tension, strict=True)]
    return apply(spec, {"zero.force": force, "zero.tension": tension})


def _span(found: list[JointState]) -> float:
    """Time from the first to the last sample, s."""
    stamps = [one.header.stamp for one in (*found[:1], *found[-1:])]
    times = [stamp.sec + stamp.nanosec / NS for stamp in stamps]
    return times[-1] - times[0] if len(found) >= FEWEST_TO_ZERO else 0.0


def _wait(conductor: Conductor, condition: Any, seconds: float, why: str) -> None:
    try:
        conductor.wait_until(condition, seconds, lambda: why)
    except StoppedError as stopped:
        raise InputError(str(stopped)) from stopped
