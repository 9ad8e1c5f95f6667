"""Clocks that drift apart: the motor's position comes later and later after its commands, or earlier, or the
motion after a known force.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import (
    CLOCK_DRIFT_CORRELATION,
    CLOCK_DRIFT_LEAST_SAMPLES,
    CLOCK_DRIFT_PARTS,
)
from rthm_analysis.diagnosis.faults.relations import related
from rthm_analysis.diagnosis.faults.smooth import Smooth, smoothed
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.result import Fault
from rthm_core.topics import PLANT_STATE

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


class Drift(NamedTuple):
    """Delay of the motion behind a known force at the start, s, and its growth, s/s."""

    delay: float
    growth: float

    def corrected(self, evidence: Evidence) -> Evidence:
        """A recording with loads as late as the motion."""
        from scipy.interpolate import CubicSpline

        time = evidence.time
        then = np.clip(time - self.delay - self.growth * time, time[0], time[-1])
        return replace(evidence, load=np.asarray(CubicSpline(time, evidence.load)(then)))

    def fault(self, evidence: Evidence) -> Fault:
        """What is told of it."""
        way = "later" if self.growth > 0.0 else "earlier"
        words = (
            f"The motion comes {way} and {way} after the known force, by {1e6 * abs(self.growth):.0f} ppm "
            f"({1e3 * abs(self.growth) * float(evidence.time[-1]):.3g} ms over the recording): their clocks "
            "drift apart. The force was moved for this diagnosis; record both with one clock."
        )
        return Fault("plant", "clock_drift", PLANT_STATE, words, None, self.growth)


def find_drift(evidence: Evidence, spec: Spec) -> tuple[Evidence, list[Fault]]:
    """Find stamps of the plant that drift against those of the commands, and correct them."""
    if evidence.driven_by != "command" or spec.plant is None or spec.actuator is None:
        return evidence, []
    smooth = smoothed(evidence, spec.plant.dofs, spec.actuator.names)
    if smooth is None:
        return evidence, []
    rates = [_drift(evidence, smooth, name) for name in spec.actuator.names]
    known = [one for one in rates if one is not None]
    if not known or len(known) < len([c for c in evidence.channels if c.family == "motor"]):
        return evidence, []
    drift = float(np.mean(known))
    stamps = np.round(evidence.stamps_ns / (1.0 + drift)).astype(np.int64)
    way = "fast" if drift > 0.0 else "slow"
    words = (
        f"The stamps of plant/state drift against those of the commands by {1e6 * abs(drift):.0f} ppm "
        f"({1e3 * abs(drift) * float(evidence.time[-1]):.3g} ms over the recording): their clock runs {way}. "
        "They were corrected for this diagnosis; synchronise the clocks of the hosts."
    )
    found = Fault("plant", "clock_drift", PLANT_STATE, words, None, drift)
    return replace(evidence, stamps_ns=stamps), [found]


def _drift(evidence: Evidence, smooth: Smooth, actuator: str) -> float | None:
    """Seconds per second by which a motor's position falls behind; None where it keeps its distance."""
    names = ("motor", actuator), ("command", actuator)
    if any(name not in smooth.values for name in names):
        return None
    motor, command = (smooth.values[name] for name in names)
    at, delay = _delays(evidence.time[smooth.rows], motor - command, smooth.rates[names[1]])
    if at.size < CLOCK_DRIFT_PARTS // 2:
        return None
    slope = np.polyfit(at, delay, 1)[0]
    steady = related(at, delay)[1]
    grows = abs(float(slope)) * float(evidence.time[-1]) > CLOCK_DRIFT_LEAST_SAMPLES * smooth.step
    return float(slope) if grows and abs(steady) > CLOCK_DRIFT_CORRELATION else None


def _delays(time: Floats, behind: Floats, rate: Floats) -> tuple[Floats, Floats]:
    """Middle and delay of each part in which the command moves, s."""
    moves = 0.1 * float(np.mean(np.square(rate)))
    at, delay = [], []
    for part in np.array_split(np.arange(time.size), CLOCK_DRIFT_PARTS):
        strength = float(np.mean(np.square(rate[part]))) if part.size else 0.0
        if part.size >= 4 and strength > moves > 0.0:
            away, along = behind[part] - behind[part].mean(), rate[part] - rate[part].mean()
            at.append(float(time[part].mean()))
            delay.append(-float(away @ along) / max(float(along @ along), 1e-300))
    return np.array(at), np.array(delay)
