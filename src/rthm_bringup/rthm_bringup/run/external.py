"""Parts of a test that somebody else starts: nodes on other hosts, and a driver of real hardware."""

from __future__ import annotations

import time

from sensor_msgs.msg import JointState

from rthm_actuator.arming import differences
from rthm_actuator.sensors import Sensors
from rthm_bringup.run.conductor_node import Conductor
from rthm_bringup.run.plan import Plan
from rthm_bringup.run.stopped import StoppedError
from rthm_bringup.run.view import View
from rthm_bringup.run.zero import check_tension, tell_zero
from rthm_core.clock import NS
from rthm_core.limits import kept_limits
from rthm_core.ros.messages import JointSample
from rthm_core.topics import PLANT_STATE

HEARTBEAT = "heartbeat"
SAME_CLOCK = 5 * NS
"""A stamp that is further from now than this was not made by a synchronised wall clock, ns."""


def wait_for_external(conductor: Conductor, plan: Plan, view: View) -> list[str]:
    """Wait until the external parts are there; return those that have a lifecycle and can be led.

    A plant without one is a driver that publishes ``plant/state`` of its own accord: its samples must flow.

    Raises
    ------
    StoppedError
        After the patience of the plan, or when the samples of the driver do not fit the spec.
    """
    parts = sorted(plan.external)
    if not parts:
        return []
    view.note(f"waiting for {', '.join(parts)} in {plan.network.place()}")
    view.phase("waiting for external parts")
    managed = [name for name in parts if name != "plant"]
    conductor.wait_for(managed, plan.patience)
    if "plant" in parts and _has_lifecycle(conductor, plan):
        managed.append("plant")
    return managed


def begin_with_driver(conductor: Conductor, plan: Plan, earliest: int) -> int:
    """Instant (ns) not before `earliest` at which the driver will sample, if it keeps the spec's period."""
    assert plan.spec.timing is not None
    period = plan.spec.timing.ns("td1")
    with conductor.samples(PLANT_STATE) as found:
        conductor.wait_until(lambda: bool(found), 5.0, lambda: "The driver stopped publishing plant/state.")
    stamp = _stamp(found[-1])
    return stamp + -(-(earliest - stamp) // period) * period


def wait_for_heartbeat(conductor: Conductor, plan: Plan, view: View) -> None:
    """Wait until an operator's heartbeat says that all is well; StoppedError if none does in time."""
    view.phase("waiting for the operator's heartbeat")
    with conductor.beats(HEARTBEAT) as found:
        conductor.wait_until(
            lambda: bool(found) and found[-1].data,
            plan.patience,
            lambda: (
                f"Nobody published a heartbeat of true in domain {plan.network.domain}"
                f" in {plan.patience:g} s."
            ),
        )


def _has_lifecycle(conductor: Conductor, plan: Plan) -> bool:
    """Whether the external plant can be led; False once the samples of a driver flow."""
    with conductor.samples(PLANT_STATE) as found:
        conductor.wait_until(
            lambda: bool(found) or conductor.is_managed("plant"),
            plan.patience,
            lambda: f"Nobody published plant/state in {plan.network.place()} in {plan.patience:g} s.",
        )
    if conductor.is_managed("plant"):
        return True
    tell_zero(conductor, plan.spec)
    with conductor.samples(PLANT_STATE) as found:  # what it publishes from now on
        conductor.wait_until(lambda: bool(found), 5.0, lambda: "The driver stopped publishing plant/state.")
    _check_names(plan, list(found[-1].name))
    _check_clock(_stamp(found[-1]))
    _check_start(plan, found[-1])
    return False


def _check_names(plan: Plan, names: list[str]) -> None:
    assert plan.spec.plant is not None
    assert plan.spec.actuator is not None
    wanted = [*plan.spec.plant.dofs, *plan.spec.actuator.names]
    if names != wanted:
        raise StoppedError(
            f"plant/state has the names {names}, but the spec has {wanted}; change one of them."
        )


def _check_start(plan: Plan, state: JointState) -> None:
    """Refuse a rig that is not where the spec begins, before anything moves."""
    arrays = state.position, state.velocity, state.effort
    if any(len(array) != len(state.name) for array in arrays):
        sizes = " and ".join(str(len(array)) for array in arrays)
        raise StoppedError(
            f"plant/state has {sizes} values of position, velocity and effort for {len(state.name)} names; "
            "give one of each for every name, NaN where nothing is measured."
        )
    limits = kept_limits(plan.spec, hardware=True)
    check_tension(plan.spec)
    sample = JointSample(_stamp(state), *(list(array) for array in arrays))
    assert limits.start is not None
    away = differences(plan.spec, Sensors(plan.spec).values(sample), limits.start)
    if away:
        raise StoppedError(
            f"Not armed, and nothing was moved: {'; '.join(one.words for one in away)}."
            " Bring the rig there, or change the spec."
        )


def _check_clock(stamp: int) -> None:
    age = time.time_ns() - stamp
    if abs(age) > SAME_CLOCK:
        raise StoppedError(
            f"A stamp of plant/state is {age / NS:.3f} s behind this host's clock;"
            " stamp it with the wall clock and synchronise the hosts."
        )


def _stamp(sample: JointState) -> int:
    return int(sample.header.stamp.sec) * NS + int(sample.header.stamp.nanosec)
