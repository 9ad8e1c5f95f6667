"""Factors that swing with time: stiffness, damping or load that swings at a frequency of its own."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import SWING_HIGHEST_RATIO, SWING_PEAKS, SWING_PERIODS
from rthm_analysis.diagnosis.missing.curves import Regression
from rthm_analysis.diagnosis.missing.residual import residual_force
from rthm_analysis.diagnosis.missing.shapes import Shape
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_analysis.diagnosis.replay.windows import period
from rthm_core.compiled import Floats
from rthm_core.effects.formula import evaluated

CARRIERS = ("x", "v")


def swinging(regression: Regression) -> Iterator[Term]:
    """Stiffness, damping and load that swing, at the frequencies that the residual force shows most."""
    spec, experiment = regression.model.spec, regression.experiment
    assert spec.plant is not None
    predicted = experiment.predicted(spec, regression.fitting.windows)
    for dof, name in enumerate(spec.plant.dofs):
        found = residual_force(experiment.evidence, spec, predicted, name)
        if found is None or not np.isfinite(found[2]).all():
            continue
        at = regression.along(dof)
        variables, time = at._asdict(), at.t
        highest = SWING_HIGHEST_RATIO * 2.0 * np.pi / period(experiment.evidence)
        for carrier in (*CARRIERS, *(["load"] if np.any(at.load) else [])):
            factor = evaluated(carrier, {}, **variables)
            for frequency in _peaks(time, found[2] * factor, highest):
                yield _fitted(regression, dof, name, carrier, frequency, factor, time)


def _peaks(time: Floats, product: Floats, highest: float) -> list[float]:
    """Frequencies, rad/s, at which the product of force and factor is strongest."""
    step = float(np.median(np.diff(time)))
    even = np.arange(time[0], time[-1], step)
    values = np.interp(even, time, product - product.mean()) * np.hanning(even.size)
    size = 4 * even.size
    power = np.abs(np.fft.rfft(values, size))
    frequency = 2.0 * np.pi * np.fft.rfftfreq(size, step)
    power[(frequency < SWING_PERIODS * 2.0 * np.pi / (time[-1] - time[0])) | (frequency > highest)] = 0.0
    found = []
    for _ in range(SWING_PEAKS):
        peak = int(np.argmax(power))
        found.append(float(frequency[peak]))
        power[max(peak - 12, 0) : peak + 13] = 0.0
    return found


def _fitted(
    regression: Regression, dof: int, name: str, carrier: str, frequency: float, factor: Floats, time: Floats
) -> Term:
    """The term at a frequency, with the phase that fits best."""
    shapes = np.stack([factor * np.sin(frequency * time), factor * np.cos(frequency * time)], axis=1)
    normal = regression.normal(regression.response(shapes, dof))
    step = 0.5 / (time[-1] - time[0])
    if normal is None:
        return Term(name, carrier, (("t", Shape("1")),), gain=-np.inf)
    sine, cosine = normal.sizes[-2:]
    base = normal.leading(normal.prior.shape[0] - 2)
    gain = float(base.left_out().sum() - normal.left_out().sum())
    shape = Shape("sin(p * w + q)", (frequency, float(np.arctan2(cosine, sine))), (step, 0.3))
    return Term(name, carrier, (("t", shape),), float(np.hypot(sine, cosine)), gain)
