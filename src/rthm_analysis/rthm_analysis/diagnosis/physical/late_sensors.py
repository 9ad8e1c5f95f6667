"""Sensors that were found to lag, where a constant delay does clearly better."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import (
    DELAY_GAIN_OVER_LAG,
    DELAY_TO_LAG_MOST,
    LAG_RUNS_IN_CONSTANTS,
    NO_LAG_S,
)
from rthm_analysis.diagnosis.numbers import bare
from rthm_analysis.diagnosis.physical.judged import begun_runs
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.evidence import Channel
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.sensing import lagged
from rthm_core.compiled import Floats


@dataclass(frozen=True)
class Lateness:
    """A constant delay in the place of a lag that was found.

    Attributes
    ----------
    channel : Channel
    delay : float
        s.
    gain : float
        Squared error that the lag leaves beyond what the delay leaves, in units of the noise.
    """

    channel: Channel
    delay: float
    gain: float

    @property
    def is_clear(self) -> bool:
        """Whether it does clearly better than the lag."""
        return self.gain > DELAY_GAIN_OVER_LAG

    @property
    def is_undecided(self) -> bool:
        """Whether neither does clearly better."""
        return abs(self.gain) <= DELAY_GAIN_OVER_LAG


def late_sensors(physical: Physical) -> list[Lateness]:
    """Delays in the place of the lags of sensors.

    The lag of a slow motion looks like a delay, but for its gain, which falls with the square of the
    frequency: with another gain beside it, it can imitate one.
    """
    lags = list(_without_lags(physical.selection.best.model))
    runs = begun_runs(physical, physical.selection.best)[0] if lags else physical.windows
    return [
        _instead(physical, channel, physical.experiment.predicted(model.spec, runs), constant)
        for channel, constant, model in lags
    ]


def undecided(found: list[Lateness]) -> tuple[str, ...]:
    """What the recording does not tell from a delay, one sentence each."""
    return tuple(
        f"The lag of the {one.channel.family} sensor of {one.channel.place} may as well be a constant delay "
        f"of {bare(1e3 * one.delay)} ms: the motion is too slow to tell."
        for one in found
        if one.is_undecided
    )


def _without_lags(model: Model) -> Iterator[tuple[Channel, float, Model]]:
    """Each sensor that lags, its time constant (s), and the model in which it does not, and has no gain."""
    for lag in model.added:
        if lag.law.changes != "smoothing" or not lag.block.startswith("sensor."):
            continue
        values, constant = model.values, 0.0
        for index, one in enumerate(model.added):
            here = (one.block, one.place) == (lag.block, lag.place)
            for place in model.places(index).values() if here else ():
                if one is lag:
                    constant, values[place] = float(values[place]), NO_LAG_S
                elif one.law.changes == "gain":
                    values[place] = 1.0
        yield Channel(lag.block.removeprefix("sensor."), lag.place), constant, model.at(values)


def _instead(physical: Physical, channel: Channel, true: Floats, constant: float) -> Lateness:
    """What a delay of a channel does in the place of a lag, both alone."""
    column, train = physical.evidence.channels.index(channel), physical.train
    time, signal = physical.evidence.time[:train], true[:train, column]
    seen, sigma = physical.evidence.measured[:train, column], physical.sigma[column]
    runs_in = time > time[0] + LAG_RUNS_IN_CONSTANTS * constant

    def left(reading: Floats) -> float:
        return float(np.nansum(np.square((seen - reading)[runs_in] / sigma)))

    after = np.append(signal[1:], signal[-1])
    lines = np.stack([signal, 0.5 * (signal + after), after], axis=1)
    delay, as_delay = _least(lambda by: left(np.interp(time - by, time, signal)), constant)
    _, as_lag = _least(lambda by: left(lagged(time, lines, by)), constant)
    return Lateness(channel, delay, as_lag - as_delay)


def _least(cost: Callable[[float], float], about: float) -> tuple[float, float]:
    """Where a cost is least in the neighbourhood of a value, and that cost."""
    from scipy.optimize import minimize_scalar

    ends = (about / DELAY_TO_LAG_MOST, about * DELAY_TO_LAG_MOST)
    found = minimize_scalar(cost, bounds=ends, method="bounded", options={"xatol": 1e-4 * about})
    return float(found.x), float(found.fun)
