"""A sensor whose zero wanders: its error is slower than the motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import WANDER_KNOT_PERIODS, WANDER_STEADY_SHARE
from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.faults.naming import fault_of, in_words
from rthm_analysis.diagnosis.faults.stretches import with_column
from rthm_analysis.diagnosis.numbers import with_unit
from rthm_analysis.diagnosis.replay.evidence import UNIT_OF, Channel, Evidence
from rthm_analysis.diagnosis.result import Fault
from rthm_core.compiled import Floats

WANDER = "wander"
"""Kind of a fault of a sensor whose zero wanders."""


class Wander(NamedTuple):
    """The error of a sensor whose zero wanders.

    Attributes
    ----------
    channel : Channel
    error : (s,) array
        Its slow part, in the unit of the channel.
    is_all : bool
        Whether nothing but noise is left of the channel without it.
    instead : tuple of str
        Places between dofs at which a slow force would make the same, and show nowhere else.
    """

    channel: Channel
    error: Floats
    is_all: bool
    instead: tuple[str, ...] = ()

    def corrected(self, evidence: Evidence) -> Evidence:
        """A recording without the error, or without the channel where more is wrong with it."""
        column = evidence.channels.index(self.channel)
        if self.is_all:
            return with_column(evidence, column, evidence.measured[:, column] - self.error)
        return evidence.without([column])

    def fault(self, evidence: Evidence) -> Fault:
        """What is told of it."""
        unit = UNIT_OF[self.channel.family]
        low, high = float(self.error.min()), float(self.error.max())
        largest = max(low, high, key=abs)
        steady = high - low < WANDER_STEADY_SHARE * abs(largest)
        off = f"is off by {with_unit(largest, unit)}"
        size = off if steady else f"wanders by up to {with_unit(abs(largest), unit)}"
        done = "The error was taken out" if self.is_all else "The signal was left out"
        words = (
            f"The zero of {in_words(self.channel)} {size}: the other signals are what the model makes of "
            f"them, and no force on a dof would move this one alone. {done} for this diagnosis; check the "
            f"sensor and its mount{_instead(self.instead)}."
        )
        return fault_of(self.channel, WANDER, words, value=largest)


def _instead(places: tuple[str, ...]) -> str:
    """What else it may be, in words."""
    if not places:
        return ""
    link = f"the link {enumerated(places)}"
    return f", or whether {link} changes its length: this recording does not tell which"


def slow_part(time: Floats, error: Floats, period: float) -> Floats:
    """The part (s,) of an error (s,) that is slower than a motion of some period, s: cubic splines between
    knots a period apart; NaN in the error where nothing was measured.
    """
    from scipy.interpolate import make_lsq_spline

    known = np.isfinite(error)
    ends = float(time[known][0]), float(time[known][-1])
    pieces = max(int((ends[1] - ends[0]) / (WANDER_KNOT_PERIODS * period)), 1)
    knots = np.concatenate([[ends[0]] * 3, np.linspace(*ends, pieces + 1), [ends[1]] * 3])
    curve = make_lsq_spline(time[known], error[known], knots, k=3)
    return np.asarray(curve(np.clip(time, *ends)), dtype=float)
