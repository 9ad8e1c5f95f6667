"""The compensator `taylor`: what the controller adds to x1 and F_d for the delays and holds of the loop.

x1 + T_x v1 and F_d + T_F dF_d/dt - T_z (k2 v1 + c2 dv1/dt), with backward differences between the latest two
samples; T_x and T_F are mean ages at the wire, holds included, T_z the mean age of the motion in a reference.
"""

from __future__ import annotations

from math import gcd
from typing import Any, NamedTuple

import numpy as np
from numba import njit


class Foresight(NamedTuple):
    """Horizons in s, stiffness and damping of the interface; all zero: no compensator."""

    position: float  # T_x
    force: float  # T_F
    motion: float  # T_z
    k2: float
    c2: float


# Slots of what the controller has latched.
X1, V1, V1_STAMP, V1_BEFORE, V1_BEFORE_STAMP, F_D, F_D_STAMP, F_D_BEFORE, F_D_BEFORE_STAMP = range(9)


def make_foresight(spec: dict[str, Any]) -> Foresight:
    """Return the compensator that the controller of a spec runs."""
    actuator, timing = spec["actuator"], spec["timing"]
    if actuator.get("compensator", "none") != "taylor":
        return Foresight(0.0, 0.0, 0.0, 0.0, 0.0)
    way = timing["tau4"] + sum(1.0 / pole for pole in actuator.get("motor_poles", ()))
    return Foresight(
        mean_age(timing["tau1"], timing["td1"], timing["td3"]) + 0.5 * timing["td3"] + way,
        timing["tau3"] + 0.5 * timing["td2"] + way,
        mean_age(timing["tau2"], timing["td1"], timing["td2"]),
        float(spec["interface"]["stiffness"][0]),
        float(spec["interface"]["damping"][0]),
    )


def mean_age(tau: float, sampled: float, used: float) -> float:
    """Mean age in s, at the ticks of one clock, of the newest sample of another that has passed a delay."""
    delay, period = round(tau * 1e9), round(sampled * 1e9)
    common = gcd(period, round(used * 1e9))
    return (delay + -delay % common + 0.5 * (period - common)) * 1e-9


@njit
def latched(x1: float, v1: float, F_d: float, td1: int, td2: int) -> np.ndarray:
    """Slots of a controller in steady state."""
    return np.array([x1, v1, 0.0, v1, -td1, F_d, 0.0, F_d, -td2])


@njit
def latch(slots: np.ndarray, first: int, value: float, stamp: float) -> None:
    """Take in a sample; the one before stays for the difference."""
    if stamp != slots[first + 1]:
        slots[first + 2], slots[first + 3] = slots[first], slots[first + 1]
    slots[first], slots[first + 1] = value, stamp


@njit
def command(slots: np.ndarray, k_tot: float, ahead: Foresight) -> float:
    """u_d, in m."""
    x1, F_d = slots[X1], slots[F_D]
    if ahead.position > 0.0:
        v1 = slots[V1]
        a1 = (v1 - slots[V1_BEFORE]) / (slots[V1_STAMP] - slots[V1_BEFORE_STAMP]) * 1e9
        rate = (F_d - slots[F_D_BEFORE]) / (slots[F_D_STAMP] - slots[F_D_BEFORE_STAMP]) * 1e9
        x1 += ahead.position * v1
        F_d += ahead.force * rate - ahead.motion * (ahead.k2 * v1 + ahead.c2 * a1)
    return x1 + F_d / k_tot
