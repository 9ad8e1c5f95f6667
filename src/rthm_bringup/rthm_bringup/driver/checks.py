"""All checks of a driver, from what was heard of it: who, how, what, when."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from rthm_bringup.driver.answer import answer_check
from rthm_bringup.driver.check import Check
from rthm_bringup.driver.heard import Heard, Sample
from rthm_bringup.driver.stamps import age_checks, stamp_checks
from rthm_core.topics import JOINT_STATE

if TYPE_CHECKING:
    from rthm_core.spec import Spec
    from rthm_core.spec.schema import Loop

ENOUGH = 10
"""Samples without which nothing can be said about stamps."""


def checks_of(heard: Heard, spec: Spec) -> tuple[Check, ...]:
    """Return all checks that can be made; those of the samples are left out when none came.

    Raises
    ------
    InputError
        If the spec describes a plant alone.
    """
    return tuple(_checks(heard, spec.loop()))


def _checks(heard: Heard, loop: Loop) -> Iterator[Check]:
    yield from _publishers(heard)
    count = len(heard.samples)
    yield Check("samples", count >= ENOUGH, count, "", f"{count} arrived; {ENOUGH} are needed to judge them")
    if count < ENOUGH:
        return
    yield from _contents(heard, loop)
    yield from stamp_checks(heard, loop.timing)
    yield from age_checks(heard, loop.timing)
    words = "somebody listens" if heard.listens else "nobody listens"
    yield Check("commands", heard.listens, int(heard.listens), "", f"{words} to actuator/command")
    if heard.commanded is not None:
        yield answer_check(heard, heard.commanded, loop)


def _publishers(heard: Heard) -> Iterator[Check]:
    found = heard.publishers
    names = ", ".join(one.node for one in found) or "nobody"
    yield Check("one publisher", len(found) == 1, len(found), "", f"plant/state comes from {names}")
    if not found:
        return
    types = sorted({one.type_name for one in found})
    wrong = sum(one.type_name != JOINT_STATE for one in found)
    yield Check("type", not wrong, wrong, "", f"{', '.join(types)}; must be {JOINT_STATE}")
    best_effort = sum(not one.reliable for one in found)
    words = "reliable" if not best_effort else "best effort, which the nodes of a test do not receive"
    yield Check("reliable", not best_effort, best_effort, "", words)


def _contents(heard: Heard, loop: Loop) -> Iterator[Check]:
    wanted = (*loop.plant.dofs, *loop.actuator.names)
    others = [one.names for one in heard.samples if one.names != wanted]
    words = ", ".join(wanted)
    if others:
        words = f"{len(others)} samples have others, such as {list(others[-1])}; the spec has {list(wanted)}"
    yield Check("names", not others, len(others), "", words)
    uneven = sum(not _sizes_fit(one) for one in heard.samples)
    words = f"{uneven} samples have arrays of another length than their names"
    yield Check("sizes", not uneven, uneven, "", words)
    unknown = sum(_lacks(one, loop) for one in heard.samples if one.names == wanted and _sizes_fit(one))
    needs = "position, measured force and, with interface damping, velocity"
    yield Check("numbers", not unknown, unknown, "", f"{unknown} samples lack a finite {needs}")


def _sizes_fit(one: Sample) -> bool:
    """Whether there is a value for each name; velocities and efforts may be left out altogether."""
    n = len(one.names)
    return len(one.position) == n and {len(one.velocity), len(one.effort)} <= {0, n}


def _lacks(one: Sample, loop: Loop) -> bool:
    """Whether a number that the loop uses is not finite, or any is infinite."""
    dofs = len(loop.plant.dofs)
    used = [*one.position, *(one.effort[dofs:] or [math.nan])]
    if any(loop.interface.damping):
        used += one.velocity[:dofs] or [math.nan]
    rest = (*one.velocity, *one.effort)
    return not all(map(math.isfinite, used)) or any(map(math.isinf, rest))
