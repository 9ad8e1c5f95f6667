"""Parts of a test that somebody else starts: nodes on other hosts, and a driver of real hardware."""

from __future__ import annotations

import time

from rthm_bringup.run.conductor_node import Conductor, StoppedError
from rthm_bringup.run.plan import Plan
from rthm_bringup.run.view import View
from rthm_core.clock import NS

SAME_CLOCK = 5 * NS
"""A stamp that is further from now than this was not made by a synchronised wall clock."""


def wait_for_external(conductor: Conductor, plan: Plan, view: View) -> list[str]:
    """Wait until the external parts are there; return those that have a lifecycle and can be led.

    A plant without one is a driver that publishes ``plant/state`` of its own accord: then its samples must flow.

    Raises
    ------
    StoppedError
        After the patience of the plan, or when the samples of the driver do not fit the spec.
    """
    parts = sorted(plan.external)
    if not parts:
        return []
    view.note(f"waiting for {', '.join(parts)} in domain {plan.network.domain}")
    view.phase("waiting for external parts")
    managed = [name for name in parts if name != "plant"]
    conductor.wait_for(managed, plan.patience)
    if "plant" in parts and _led_plant(conductor, plan):
        managed.append("plant")
    return managed


def _led_plant(conductor: Conductor, plan: Plan) -> bool:
    """Whether the external plant has a lifecycle; False once a driver's samples flow."""
    samples = conductor.samples("plant/state")
    conductor.wait_until(
        lambda: bool(samples) or conductor.is_managed("plant"),
        plan.patience,
        lambda: f"Nobody published plant/state in domain {plan.network.domain} within {plan.patience:g} s.",
    )
    if conductor.is_managed("plant"):
        return True
    _check_names(plan, list(samples[-1].name))
    _check_clock(samples[-1].header.stamp)
    return False


def _check_names(plan: Plan, names: list[str]) -> None:
    assert plan.spec.plant is not None
    assert plan.spec.actuator is not None
    wanted = [*plan.spec.plant.dofs, *plan.spec.actuator.names]
    if names != wanted:
        raise StoppedError(f"plant/state has the names {names}, but the spec has {wanted}; change one of them.")


def _check_clock(stamp: object) -> None:
    age = time.time_ns() - (stamp.sec * NS + stamp.nanosec)  # type: ignore[attr-defined]
    if abs(age) > SAME_CLOCK:
        raise StoppedError(
            f"The stamp of plant/state is {age / NS:.3f} s old; stamp it with the wall clock and synchronise the hosts."
        )
