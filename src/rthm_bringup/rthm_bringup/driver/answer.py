"""Whether the motors of a driver go where they are commanded to, and how much later."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_bringup.driver.check import Check
from rthm_bringup.driver.heard import Commanded, Heard
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec
    from rthm_core.spec.schema import Loop

LONGEST_ANSWER = 0.5
"""Longest delay of an answer that is looked for, s."""

DELAY_STEP = 2.5e-4
"""Distance of the delays that are tried, s."""

ERROR = 0.1
"""Error of an answer, over the swing of the command, that is no fault."""


def swing(start: Floats, distance: float, share: float) -> Floats:
    """Command (m,) at a share (0 to 1) of one smooth swing: to `distance` (m) from `start` and back."""
    return np.asarray(start + 0.5 * distance * (1.0 - np.cos(2.0 * np.pi * share)))


def check_swing(start: Floats, distance: float, seconds: float, spec: Spec) -> None:
    """Raise InputError when a swing from `start` (m,) would pass a limit of the spec, or cannot begin."""
    if not np.all(np.isfinite(start)):
        raise InputError("plant/state has no motor positions, from which a swing would start; add them.")
    if spec.limits is None:
        return
    largest = float(np.abs(np.stack([start, start + distance])).max())
    rate = np.pi * abs(distance) / seconds
    for name, value, allowed, unit in (
        ("command", largest, spec.limits.command, "m"),
        ("rate", rate, spec.limits.rate, "m/s"),
    ):
        if allowed is not None and value > allowed:
            raise InputError(
                f"The swing reaches a {name} of {value:.4g} {unit}, but limits.{name} of the spec is"
                f" {allowed:.4g} {unit}; ask for a smaller or a slower one."
            )


def answer_check(heard: Heard, commanded: Commanded, loop: Loop) -> Check:
    """Worst error of any motor, in parts of the swing, with each at the delay that fits it best."""
    dofs, m = len(loop.plant.dofs), len(loop.actuator.names)
    known = [one for one in heard.samples if len(one.position) == dofs + m]
    if not known or commanded.stamp_ns.size < 2:
        return Check("answers", False, float("nan"), "", "no motor positions, or no commands, were seen")
    first = commanded.stamp_ns[0]
    at = np.array([one.stamp_ns - first for one in known]) * 1e-9
    sent = (commanded.stamp_ns - first) * 1e-9
    moved = np.array([one.position[dofs:] for one in known])
    fits = [fitted_delay(at, moved[:, k], sent, commanded.position[:, k]) for k in range(m)]
    delay, error = max(fits, key=lambda fit: fit[1])
    words = (
        f"the motors follow {1e3 * delay:.4g} ms later (tau4 is {1e3 * loop.timing.tau4:g} ms) with an error"
        f" of {100.0 * error:.3g} % of the swing; allowed {100.0 * ERROR:g} %"
    )
    return Check("answers", error <= ERROR, error, "", words)


def fitted_delay(at: Floats, moved: Floats, sent: Floats, command: Floats) -> tuple[float, float]:
    """Delay (s) at which a motion fits the held command best, and the rms error over the command's range."""
    delays = np.arange(0.0, LONGEST_ANSWER, DELAY_STEP)
    errors = [
        float(np.sqrt(np.mean((moved - np.interp(at - delay, sent, command)) ** 2))) for delay in delays
    ]
    best = int(np.argmin(errors))
    return float(delays[best]), errors[best] / max(float(np.ptp(command)), 1e-300)
