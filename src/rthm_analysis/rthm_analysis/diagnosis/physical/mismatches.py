"""How far each block of the physical side is off, over the noise."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.physical.fits import channel_of
from rthm_analysis.diagnosis.physical.judged import Simulated
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.experiment import SENSORS
from rthm_analysis.diagnosis.result import Mismatch
from rthm_core.compiled import Floats


def mismatches(physical: Physical, runs: dict[str, Simulated], located: set[str]) -> tuple[Mismatch, ...]:
    """One-block prediction errors over their noise."""
    measured, settled = physical.evidence.measured, runs["nominal"].predicted
    residual = measured - settled
    found = []
    for block in ("plant", "wire", *SENSORS):
        k = channel_of(physical, block)
        if k is None:
            continue
        if block == "wire":
            error = _wire_error(physical, residual, k)
        elif block == "plant":
            error = residual[:, k] / physical.sigma[k]
        else:
            error = ((measured - runs["explained"].predicted)[:, k]) / physical.sigma[k]
            if block in located:
                error = residual[:, k] / physical.sigma[k]
        found.append(Mismatch(block, _rms(error), block in located))
    if physical.drives:
        first = physical.drives[0]
        count = max(first[0].fitted.samples, 1)
        found.append(Mismatch("motor", float(np.sqrt(first[-1].fitted.squares / count)), True))
    elif physical.evidence.driven_by == "command":
        left = physical.motor_left
        found.append(Mismatch("motor", _rms(left) if left.size else 1.0, "motor" in located))
    return tuple(found)


def _wire_error(physical: Physical, residual: Floats, k: int) -> Floats:
    """Error of the force alone: what the error of the position it pulls at explains is taken out."""
    spec, channels = physical.settled, physical.evidence.channels
    assert spec.actuator is not None and spec.interface is not None
    actuator = spec.actuator.names.index(channels[k].place)
    stiffness, dof = spec.k_tot[actuator], spec.interface.plant_dof[actuator]
    for i, channel in enumerate(channels):
        if channel.family == "position" and channel.place == dof:
            noise = np.hypot(physical.sigma[k], stiffness * physical.sigma[i])
            return np.asarray((residual[:, k] + stiffness * residual[:, i]) / noise)
    return np.asarray(residual[:, k] / physical.sigma[k])


def _rms(error: Floats) -> float:
    return float(np.sqrt(np.nanmean(np.square(error))))
