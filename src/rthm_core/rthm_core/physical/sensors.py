"""Sensors: what is measured of the motion and the force, with noise and what effects change.

A measured value is ``gain * smoothed + offset + growth t``, plus noise, rounded to a step.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rthm_core.chance import normal_at, stream_key
from rthm_core.compiled import Floats, Integers, inlined
from rthm_core.spec.effect import sizes

if TYPE_CHECKING:
    from rthm_core.effects.declaration import Change
    from rthm_core.spec import Spec

CHANNELS = ("position", "velocity", "force", "motor")


class Sensors(NamedTuple):
    """All channels in the order n positions, n velocities, m forces, m motor positions; S rows.

    Attributes
    ----------
    values : (S, 5) array
        Gain, offset, its growth per second, step and standard deviation of the noise.
    lagged : (S,) array
        Index of the state of a lagging sensor; -1: none.
    key : (S,) array
        Key of the channel's noise.
    """

    values: Floats
    lagged: Integers
    key: Any


def _channels(spec: Spec) -> list[tuple[str, str]]:
    dofs = spec.plant.dofs if spec.plant else ()
    names = spec.actuator.names if spec.actuator else ()
    wheres = {"position": dofs, "velocity": dofs, "force": names, "motor": names}
    return [(channel, where) for channel in CHANNELS for where in wheres[channel]]


def sensor_states(spec: Spec) -> int:
    """How many lagging sensors there are."""
    return sum(bool(_sizes(spec, channel, where, "smoothing")) for channel, where in _channels(spec))


def _sizes(spec: Spec, channel: str, where: str, changes: Change) -> list[float]:
    return sizes(spec.effects, f"sensor.{channel}", changes, where)


def sensors(spec: Spec, parts: Any, at: int, *, measured: bool = True) -> Sensors:
    """Sensors of a spec, or none at all when nothing is `measured`; the dynamics of those that lag are
    written into the matrices of `parts` from state `at` on.
    """
    channels = _channels(spec) if measured else []
    lagged = np.full(len(channels), -1, dtype=np.int64)
    values = np.empty((len(channels), 5))
    for row, (channel, where) in enumerate(channels):
        values[row] = (
            np.prod(_sizes(spec, channel, where, "gain")),
            sum(_sizes(spec, channel, where, "offset")),
            sum(_sizes(spec, channel, where, "growth")),
            max(_sizes(spec, channel, where, "step"), default=0.0),
            getattr(spec.noise, channel),
        )
        lag = sum(_sizes(spec, channel, where, "smoothing"))
        if lag > 0.0:
            lagged[row] = at
            _add_lag(parts, channel, row, at, lag)
            at += 1
    keys = np.array(
        [stream_key(int(spec.noise.seed), f"{channel}.{where}") for channel, where in channels],
        dtype=np.uint64,
    )
    return Sensors(values, lagged, keys)


def _add_lag(parts: Any, channel: str, row: int, at: int, time_constant: float) -> None:
    parts.a[at, at] = -1.0 / time_constant
    if channel == "force":
        parts.b_f[at, row - 2 * parts.n] = 1.0 / time_constant
    else:
        parts.a[at, row] = 1.0 / time_constant


@inlined
def measured(sensors, row, true, y, stamp):  # type: ignore[no-untyped-def]
    """Measured value of channel `row` whose true value is `true`, for the sample stamped `stamp` (ns since
    the start).
    """
    settings = sensors.values
    value = y[sensors.lagged[row]] if sensors.lagged[row] >= 0 else true
    value = settings[row, 0] * value + settings[row, 1] + settings[row, 2] * stamp * 1e-9
    if settings[row, 4] > 0.0:
        value += settings[row, 4] * normal_at(sensors.key[row], stamp)
    if settings[row, 3] > 0.0:
        value = settings[row, 3] * math.floor(value / settings[row, 3] + 0.5)
    return value
