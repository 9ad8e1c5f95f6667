"""How well the actuators of one test did what they were told: position and force."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.comparison.lateness import lateness
from rthm_analysis.comparison.measures import (
    Evaluation,
    frequency_evaluation,
    peak_error,
    tracking_indicator,
)
from rthm_analysis.comparison.motion import Motion, Pair, paired
from rthm_analysis.outcome.ideal import error_of

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

FOLLOWED = (("command", "motor"), ("reference", "force"))
"""What an actuator is told, and what follows it."""

AVERAGED = 0.05
"""Part of a mean period over which signals are averaged before their delay is measured."""


@dataclass(frozen=True)
class Tracking:
    """Measures of one signal that should follow another in the same test.

    Attributes
    ----------
    wanted, got : str
        Names of the signals.
    unit : str
        Of both.
    delay : float
        J1, s, + where it is late.
    nrmse, peak : float
        J2 and J3.
    evaluation : Evaluation
        Frequency evaluation index.
    indicator : float
        Tracking indicator at the end, in the square of the unit.
    """

    wanted: str
    got: str
    unit: str
    delay: float
    nrmse: float
    peak: float
    evaluation: Evaluation
    indicator: float

    def as_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        return {
            "wanted": self.wanted,
            "J1": self.delay,
            "J2": self.nrmse,
            "J3": self.peak,
            "FEI": self.evaluation.as_dict(),
            "TI": self.indicator,
        }


def trackings_of(motion: Motion) -> list[Tracking]:
    """Measures of all actuators of a test, as far as their signals are known; none of an ideal one, which is
    what it is told to be.
    """
    found = []
    for actuator in motion.actuators:
        for told, did in FOLLOWED:
            wanted, got = (motion.signals.get(f"{actuator}.{what}") for what in (told, did))
            if wanted is not None and got is not None:
                pair = paired(wanted, got)
                if pair.time.size > 1 and not np.array_equal(pair.one, pair.other):
                    found.append(tracking(wanted.name, got.name, got.unit, pair))
    return found


def tracking(wanted: str, got: str, unit: str, pair: Pair) -> Tracking:
    """Measures of a pair of signals, the wanted one first."""
    error = error_of(pair.other - pair.one, pair.one)
    step, one, other = _even(pair)
    evaluation = frequency_evaluation(step, one, other)
    return Tracking(
        wanted,
        got,
        unit,
        _delay(step, one, other, evaluation.frequency),
        error.nrmse,
        peak_error(pair.one, pair.other),
        evaluation,
        tracking_indicator(pair.one, pair.other),
    )


def _delay(step: float, one: Floats, other: Floats, frequency: float) -> float:
    """Delay of the motion, not of the steps in which a held signal goes: both are averaged over the same
    short part of a period, which delays both alike.
    """
    count = round(AVERAGED / (frequency * step)) if frequency > 0.0 else 0
    if 1 < count < one.size:
        one, other = _averaged(one, count), _averaged(other, count)
    return lateness(step * np.arange(one.size, dtype=float), one, other).delay.value


def _averaged(values: Floats, count: int) -> Floats:
    """Means of so many neighbours."""
    return np.convolve(values, np.full(count, 1.0 / count), "valid").astype(float)


def _even(pair: Pair) -> tuple[float, Floats, Floats]:
    """Step (s) and both signals at even instants, where they are not so already."""
    steps = np.diff(pair.time)
    step = float(np.median(steps))
    if np.ptp(steps) < 1e-6 * step:
        return step, pair.one, pair.other
    even = np.arange(pair.time[0], pair.time[-1], step)
    return step, np.interp(even, pair.time, pair.one), np.interp(even, pair.time, pair.other)
