"""Sensors: what the recording, and with it the loop, sees of a value."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit


class Sensor(NamedTuple):
    """Parameters of one channel: lag -> scale -> bias, drift -> noise -> quantisation."""

    lag: float  # s
    scale: float
    bias: float
    drift: float  # per second
    step: float
    noise: float  # standard deviation


@njit
def read(t: float, value: float, lagged: float, deviate: float, sensor: Sensor) -> float:
    """Reading of `value`; `lagged` is the same behind the sensor's lag, `deviate` standard normal."""
    seen = lagged if sensor.lag > 0.0 else value
    seen = sensor.scale * seen + sensor.bias + sensor.drift * t + sensor.noise * deviate
    return np.round(seen / sensor.step) * sensor.step if sensor.step > 0.0 else seen
