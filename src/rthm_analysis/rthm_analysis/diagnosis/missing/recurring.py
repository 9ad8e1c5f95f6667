"""What comes back again and again: factors that swing with time, and a force that recurs along the way."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    PITCH_BIN_SAMPLES,
    PITCH_BINS,
    PITCH_BINS_MOST,
    PITCH_RANGE_SHARE,
    SWING_HIGHEST_RATIO,
    SWING_PEAKS,
    SWING_PERIODS,
)
from rthm_analysis.diagnosis.missing.binned import binned
from rthm_analysis.diagnosis.missing.curves import Regression
from rthm_analysis.diagnosis.missing.residual import residual_force
from rthm_analysis.diagnosis.missing.shapes import WAVE, Shape
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_core.compiled import Floats
from rthm_core.effects.formula import evaluated

CARRIERS = ("x", "v")


def swinging(regression: Regression) -> Iterator[Term]:
    """Stiffness, damping and load that swing, at the frequencies that the residual force shows most."""
    for site, name, force in _residual_forces(regression):
        at = regression.along(site)
        highest = SWING_HIGHEST_RATIO * 2.0 * np.pi / regression.experiment.evidence.period
        step = float(np.median(np.diff(at.t)))
        even = np.arange(at.t[0], at.t[-1], step)
        for carrier in (*CARRIERS, *(["load"] if np.any(at.load) else [])):
            factor = evaluated(carrier, {}, **at._asdict())
            swings = np.interp(even, at.t, force * factor)
            for frequency in _peaks(swings, step, highest):
                yield _swing(regression, site, name, carrier, frequency, factor)


def recurring(regression: Regression) -> Iterator[Term]:
    """A force that comes back with the position, as between teeth or magnets, at the pitches that the
    residual force shows most: finer ones than a free curve can show.
    """
    for site, name, force in _residual_forces(regression):
        x = regression.along(site).x
        count = min(x.size // PITCH_BIN_SAMPLES, PITCH_BINS_MOST)
        low, high = np.quantile(x, (PITCH_RANGE_SHARE, 1.0 - PITCH_RANGE_SHARE))
        if count < 2 * PITCH_BINS or low >= high:
            continue
        edges, inside = np.linspace(low, high, count + 1), (low <= x) & (x <= high)
        at, mean, _, _ = binned(x[inside], force[inside], edges)
        step = float(edges[1] - edges[0])
        even = np.interp(edges[:-1] + 0.5 * step, at, mean)
        for wave_number in _peaks(even, step, 2.0 * np.pi / (PITCH_BINS * step)):
            yield _recurrence(regression, site, name, 2.0 * np.pi / wave_number)


def _residual_forces(regression: Regression) -> Iterator[tuple[int, str, Floats]]:
    """Number and name of each site, and the force (s,) that a model lacks there."""
    spec, experiment = regression.model.spec, regression.experiment
    predicted = experiment.predicted(spec, regression.windows)
    for site, (name, _) in enumerate(regression.sites):
        found = residual_force(experiment.evidence, spec, predicted, name)
        if found is not None and np.isfinite(found[2]).all():
            yield site, name, found[2]


def _peaks(values: Floats, step: float, highest: float) -> list[float]:
    """Angular frequencies, up to the highest, at which some values, even `step`s apart, are strongest."""
    size = 4 * values.size
    power = np.abs(np.fft.rfft((values - values.mean()) * np.hanning(values.size), size))
    frequency = 2.0 * np.pi * np.fft.rfftfreq(size, step)
    lowest = SWING_PERIODS * 2.0 * np.pi / (values.size * step)
    power[(frequency < lowest) | (frequency > highest)] = 0.0
    found = []
    for _ in range(SWING_PEAKS):
        peak = int(np.argmax(power))
        if power[peak] == 0.0:
            break
        found.append(float(frequency[peak]))
        power[max(peak - 12, 0) : peak + 13] = 0.0
    return found


def _swing(
    regression: Regression, site: int, name: str, carrier: str, frequency: float, factor: Floats
) -> Term:
    """A factor that swings at a frequency."""
    time = regression.along(site).t
    size, phase, gain = _in_phase(regression, site, factor, frequency * time)
    steps = (0.5 / float(time[-1] - time[0]), 0.3)
    shape = Shape("sin(p * w + q)", (frequency, phase), steps)
    return Term(name, carrier, (("t", shape),), size, gain)


def _recurrence(regression: Regression, site: int, name: str, pitch: float) -> Term:
    """A force of a pitch."""
    x = regression.along(site).x
    size, phase, gain = _in_phase(regression, site, np.ones_like(x), 2.0 * np.pi * x / pitch)
    steps = (0.1 * pitch**2 / float(np.ptp(x)), 0.3)
    return Term(name, "1", (("x", Shape(WAVE, (pitch, phase), steps)),), size, gain)


def _in_phase(regression: Regression, site: int, factor: Floats, angle: Floats) -> tuple[float, float, float]:
    """Size and phase of a factor times the sine of an angle that fit best, and what they gain."""
    shapes = np.stack([factor * np.sin(angle), factor * np.cos(angle)], axis=1)
    normal = regression.normal(regression.response(shapes, site))
    if normal is None:
        return 0.0, 0.0, -np.inf
    sine, cosine = normal.sizes[-2:]
    base = normal.leading(normal.prior.shape[0] - 2)
    gain = float(base.left_out().sum() - normal.left_out().sum())
    return float(np.hypot(sine, cosine)), float(np.arctan2(cosine, sine)), gain
