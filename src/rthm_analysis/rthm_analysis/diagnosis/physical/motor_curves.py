"""What a motor's position has beyond what its commands make, over its own position or time."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import FORETOLD_SHARE, MOTOR_CURVE_BINS, SAMPLED_TRAINED
from rthm_analysis.diagnosis.missing.binned import binned
from rthm_analysis.diagnosis.missing.describe import symmetry_of
from rthm_analysis.diagnosis.numbers import bare, percent
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.result import Described
from rthm_core.compiled import Flags, Floats

ON = {"u": "where it is", "t": "time"}


def motors_described(physical: Physical) -> Iterator[Described]:
    """Motors whose error is a curve over their own position, or a straight line over time; in no model.

    The curve is made of the first part of the training samples and asked of the others.
    """
    actuator, left = physical.spec.actuator, physical.motor_left
    if actuator is None or not left.size:
        return
    motion = physical.experiment.motion(physical.selection.best.model.spec, physical.windows)
    time = physical.evidence.time[: left.shape[0]]
    for k, name in enumerate(actuator.names):
        error = left[:, k] * physical.motor_noise[k]
        known = np.isfinite(error)
        first = known & (np.arange(error.size) < SAMPLED_TRAINED * error.size)
        u = motion.motor[: error.size, k]
        curves = {"u": _over(u, error, first), "t": _line(time, error, first)}
        shares = {
            one: _share(left[:, k], curve / physical.motor_noise[k], known & ~first)
            for one, curve in curves.items()
        }
        best = max(shares, key=lambda one: shares[one])
        if shares[best] < FORETOLD_SHARE:
            continue
        over = {"u": u, "t": time}[best]
        at, mean, std, _ = binned(over[known], error[known])
        low, high = float(over[known].min()), float(over[known].max())
        size = bare(float(np.abs(error[known]).max()), 2)
        seen = f" (seen from {bare(low)} to {bare(high)} m)" if best == "u" else ""
        kind = "curve over its position" if best == "u" else "straight line over time"
        words = (
            f"The motor of {name} is up to {size} m away from where its commands put it, and that depends on "
            f"{ON[best]}{seen}. A {kind} explains {percent(min(shares[best], 1.0))} of it on data that chose "
            "nothing; no kind of the library fits it."
        )
        yield Described(
            "motor", name, (best,), symmetry_of(at, mean) if best == "u" else "neither", False, False,
            None, None, {"u": (low, high)} if best == "u" else {}, shares[best], 0.0, at, mean, std, words,
            unit="m",
        )  # fmt: skip


def _over(u: Floats, error: Floats, part: Flags) -> Floats:
    """Error (s,) by the means of a part in even bins of the position, straight between their middles."""
    edges = np.linspace(u[part].min(), u[part].max(), MOTOR_CURVE_BINS + 1)
    at, mean, _, _ = binned(u[part], error[part], edges)
    return np.asarray(np.interp(u, at, mean))


def _line(time: Floats, error: Floats, part: Flags) -> Floats:
    """Error (s,) by the straight line over time that fits a part."""
    slope, offset = np.polyfit(time[part], error[part], 1)
    return np.asarray(offset + slope * time)


def _share(left: Floats, curve: Floats, part: Flags) -> float:
    """Part of the squared error above the noise that a curve explains, both over the noise; 0 without any."""
    before, after = (float(np.mean(np.square(one[part]))) - 1.0 for one in (left, left - curve))
    return 1.0 - max(after, 0.0) / before if before > 1.0 else 0.0
