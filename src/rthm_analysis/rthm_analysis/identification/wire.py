"""Stiffness between a motor and its dof, and the signs and scales of what is measured there.

``F = a u - b x + constant``: with right signs and units a and b are both k_tot.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.identification.estimate import BEYOND_ZERO, Fit, through

if TYPE_CHECKING:
    from rthm_analysis.identification.evidence import Motion

UNLIKE = 0.1
"""Relative difference of a and b that is no fault."""
FURTHER = "correct it, and measure again."


def stiffness(motion: Motion) -> Fit:
    """k_tot (N/m) and the force at no elongation (N)."""
    return through((motion.motor - motion.position)[:, None], motion.force)


def signs(motion: Motion, gain: float) -> list[str]:
    """Sentences about signs and scales that cannot be right; `gain` is that of the motor."""
    wrong = _of_the_motor(motion, gain)
    if not wrong:
        wrong = _of_the_wire(motion)
    return wrong + _of_the_velocity(motion)


def _of_the_motor(motion: Motion, gain: float) -> list[str]:
    name = motion.actuator
    if gain < 0.0:
        return [
            f"The motor of {name} moves against its command (by {gain:.3g} of it): its position sensor, or"
            f" its direction, has the wrong sign; {FURTHER}"
        ]
    if not 0.8 < gain < 1.25:
        return [
            f"The motor of {name} moves by {gain:.3g} of its command, but must move by all of it: the unit of"
            f" its position or of its command is wrong; {FURTHER}"
        ]
    return []


def _of_the_wire(motion: Motion) -> list[str]:
    name, dof = motion.actuator, motion.dof
    fit = through(np.column_stack([motion.motor, -motion.position]), motion.force)
    if not fit.is_certain(0):
        return []
    by_motor, by_dof = float(fit.value[0]), float(fit.value[1])
    told = f"the force of {name} grows by {by_motor:.4g} N/m with its motor"
    if not fit.is_certain(1):
        return _reversed(name, told) if by_motor < 0.0 else []
    told += f" and by {-by_dof:.4g} N/m with {dof}"
    if by_motor < 0.0 and by_dof < 0.0:
        return _reversed(name, told)
    if by_motor < 0.0:
        return [f"T{told[1:]}: the direction of the motor of {name} has the wrong sign; {FURTHER}"]
    if by_dof < 0.0:
        return [f"T{told[1:]}: the position of {dof} has the wrong sign; {FURTHER}"]
    spread = float(np.sqrt(fit.covariance[0, 0] + fit.covariance[1, 1] - 2.0 * fit.covariance[0, 1]))
    if abs(by_motor - by_dof) > max(BEYOND_ZERO * spread, UNLIKE * max(by_motor, by_dof)):
        return [
            f"T{told[1:]}, which no spring between the two does: the unit of one of the positions is wrong,"
            f" or something else pulls at the load cell; {FURTHER}"
        ]
    return []


def _reversed(name: str, told: str) -> list[str]:
    return [
        f"T{told[1:]}: the force has the wrong sign, + has to pull {name}'s dof along + x; reverse the load"
        " cell or its sign in the driver, and measure again."
    ]


def _of_the_velocity(motion: Motion) -> list[str]:
    if not np.isfinite(motion.velocity).all():
        return []
    rate = np.gradient(motion.position, motion.time)
    fit = through(motion.velocity[:, None], rate)
    if not fit.is_certain(0) or 0.5 < fit.value[0] < 2.0:
        return []
    if fit.value[0] < 0.0:
        return [
            f"The velocity of {motion.dof} has the sign of the other direction than its position; {FURTHER}"
        ]
    return [
        f"The position of {motion.dof} changes by {fit.value[0]:.3g} of its velocity, but must by all of"
        f" it: one of the two has the wrong unit; {FURTHER}"
    ]
