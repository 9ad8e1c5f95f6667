"""How far motors may go to measure a rig: what the spec predicts for it, beside what the limits allow."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.excitation import QUIET_START, excitation
from rthm_core.limits import limit_units
from rthm_core.physical import PhysicalSide

if TYPE_CHECKING:
    from rthm_core.spec import Spec

SHARE_OF_LIMITS = 0.25
"""Part of what each limit leaves that is used: the spec may be wrong, which is why the rig is measured."""
UNITS = limit_units("command", "rate", "force", "position", "velocity", "measured_force", "following")
"""Limits that a motion is compared with, and their units."""


class Reach(NamedTuple):
    """How much of a limit a motion uses.

    Attributes
    ----------
    limit
        Its name.
    at_rest, moved
        Largest value before the motion, and by how much it grows, in the unit of the limit.
    allowed
        Value of the limit.
    """

    limit: str
    at_rest: float
    moved: float
    allowed: float


def safe_travel(spec: Spec, seconds: float) -> float:
    """Largest motion (m) with which no limit is used by more than a quarter of what it leaves.

    Parameters
    ----------
    spec
        With all limits of a real machine; the prediction is its own.
    seconds
        Length of the motion, s.

    Raises
    ------
    InputError
        If a limit leaves nothing.
    """
    assert spec.limits is not None
    assert spec.limits.command is not None
    trial = 0.01 * spec.limits.command
    shares = {}
    for one in reaches(spec, trial, seconds):
        left = one.allowed - one.at_rest
        if left <= 0.0:
            raise _refused(one)
        shares[one.limit] = SHARE_OF_LIMITS * left / max(one.moved, 1e-300)
    return float(f"{trial * min(shares.values()):.3g}")


def check_travel(spec: Spec, travel: float, seconds: float) -> None:
    """Raise InputError when a motion would pass a limit of the spec, as far as the spec knows."""
    for one in reaches(spec, travel, seconds):
        if one.at_rest + one.moved > one.allowed:
            raise _refused(one)


def reaches(spec: Spec, travel: float, seconds: float) -> list[Reach]:
    """Predict what a motion of some size (m) does to each limit that the spec has."""
    limits = spec.limits
    assert limits is not None
    still, moved = _predicted(spec, travel, seconds)
    given = {"measured_force": limits.measured_force or limits.force}
    found = [(name, getattr(limits, name) or given.get(name)) for name in UNITS]
    return [
        Reach(name, still[name], max(moved[name] - still[name], 0.0), float(allowed))
        for name, allowed in found
        if allowed is not None
    ]


def _predicted(spec: Spec, travel: float, seconds: float) -> tuple[dict[str, float], dict[str, float]]:
    """Largest values at the start, and during the motion."""
    timing, side, motion = spec.loop().timing, PhysicalSide(_silent(spec)), excitation(spec, travel)
    first = side.sample(0)
    times = range(0, round((QUIET_START + seconds) * NS), timing.ns("td3"))
    command = np.array([first.motor_position + motion.at(at / NS) for at in times])
    late = -(-timing.ns("tau4") // timing.ns("td3"))
    rows = []
    for k, at in enumerate(times):
        side.command(at, command[max(k - late, 0)])
        one = side.sample(at)
        rows.append([one.force, one.position, one.velocity, one.motor_position - command[k]])
    force, position, velocity, behind = (np.array(column) for column in zip(*rows, strict=True))
    values = {
        "command": command,
        "rate": np.diff(command, axis=0, prepend=command[:1]) / timing.td3,
        "force": force,
        "position": position,
        "velocity": velocity,
        "measured_force": force,
        "following": behind,
    }
    return (
        {name: float(np.abs(value[0]).max()) for name, value in values.items()},
        {name: float(np.abs(value).max()) for name, value in values.items()},
    )


def _silent(spec: Spec) -> Spec:
    """The spec without noise, of which limits know nothing."""
    return spec.model_copy(update={"noise": type(spec.noise)()})


def _refused(one: Reach) -> InputError:
    unit = UNITS[one.limit]
    return InputError(
        f"The motion is predicted to reach a {one.limit} of {one.at_rest + one.moved:.4g} {unit}, but"
        f" limits.{one.limit} allows {one.allowed:.4g} {unit}; ask for a smaller --travel."
    )
