"""Effects of the sensors on a replayed signal: lag, scale, bias, drift and quantisation, in this order."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba
import numpy as np

from rthm_core.compiled import Floats

if TYPE_CHECKING:
    from rthm_core.spec.schema import EffectSpec


def sensed(time: Floats, true: Floats, effects: list[EffectSpec]) -> Floats:
    """Reading (s,) of a signal that is `true` (s,) at the instants `time` (s), without noise."""
    value = true
    for effect in effects:
        if effect.kind == "lag" and float(effect.parameters["time_constant"]) > 0.0:
            value = _lagged(time, value, float(effect.parameters["time_constant"]))
    for effect in effects:
        if effect.kind == "scale":
            value = value * float(effect.parameters["scale"])
    for effect in effects:
        if effect.kind == "bias":
            value = value + float(effect.parameters["bias"])
        elif effect.kind == "drift":
            value = value + float(effect.parameters["rate"]) * time
    return value


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _lagged(time: Floats, signal: Floats, time_constant: float) -> Floats:
    """First-order lag of a signal that runs in straight lines between its samples."""
    out = np.empty_like(signal)
    out[0] = signal[0]
    for i in range(1, signal.size):
        h = time[i] - time[i - 1]
        decay = np.exp(-h / time_constant)
        slope = (signal[i] - signal[i - 1]) / h
        # The lag follows a ramp at a distance of slope times time constant.
        out[i] = (
            signal[i] - slope * time_constant + (out[i - 1] - signal[i - 1] + slope * time_constant) * decay
        )
    return out
