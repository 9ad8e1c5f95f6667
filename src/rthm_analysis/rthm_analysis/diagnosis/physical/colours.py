"""The colour of the noise of each channel, from what a fitted model leaves of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.fitting.colour import Colour, colour_of
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.fitting.noise import Noise
from rthm_core.compiled import Floats

SHIFTS = (-2, -1, 0, 1, 2)
"""Samples by which a predicted force is shifted: with all of them goes what a wrong wire or motor leaves."""

MEASURED = 0.9
"""Part of the samples that must be readings, for their neighbours to tell a colour."""


def coloured(fitting: Fitting, fitted: Fitted, noise: Noise) -> Noise:
    """Noise with its colour, from the residual of a model whose initial states are fitted.

    The force of a wire jumps with every command, and a wire that is slightly wrong leaves jumps that look
    like noise which wanders. So what the predicted force itself explains is taken out of its residual.
    """
    evidence, left = fitting.experiment.evidence, left_by(fitting, fitted)
    colours: list[Colour] = []
    for k, channel in enumerate(evidence.channels):
        error = left[:, k]
        if channel.family == "force":
            error = _without(error, evidence.measured[:, k])
        if np.isfinite(error).mean() < MEASURED:
            colours.append(noise.colours[k])
            continue
        colours.append(colour_of(error, evidence.measured[:, k], noise.colours[k].level))
    return Noise(tuple(colours))


def left_by(fitting: Fitting, fitted: Fitted) -> Floats:
    """What a fitted model leaves (s, k), in the units of the channels, the initial states fitted, too."""
    plain = replace(fitting, colours=())
    errors = plain.projected(plain.residual(fitted.model)).reshape(fitting.weight.shape)
    with np.errstate(divide="ignore"):
        return errors * np.where(fitting.weight > 0.0, 1.0 / fitting.weight, np.nan)


def _without(error: Floats, force: Floats) -> Floats:
    """Error (s,) without what a force (s,), late or early by some samples, explains of it."""
    known = np.isfinite(error) & np.isfinite(force)
    columns = np.stack([np.roll(np.nan_to_num(force), shift) for shift in SHIFTS], axis=1)
    sizes = np.linalg.lstsq(columns[known], error[known], rcond=1e-10)[0]
    return np.asarray(error - columns @ sizes)
