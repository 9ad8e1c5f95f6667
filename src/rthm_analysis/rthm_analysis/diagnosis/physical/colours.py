"""The colour of the noise of each channel, from what a fitted model leaves of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from rthm_analysis.diagnosis.criteria.noise import (
    COHERENCE_CHANCE,
    COHERENT_FREQUENCIES,
    COLOUR_FEWEST_READINGS_SHARE,
    FORETELLING_SHIFTS,
    OWN_VALUE_LEVELS,
    OWN_VALUE_SHARE,
    OWN_VALUE_STRETCHES,
    SLOW_POWER_WHITE,
)
from rthm_analysis.diagnosis.fitting.colour import Colour, colour_of, whitened_from
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.fitting.noise import Noise
from rthm_analysis.diagnosis.physical.remainder import slow_power
from rthm_analysis.diagnosis.physical.unrelated import is_rare, possible_causes, unrelated
from rthm_core.compiled import Flags, Floats, Integers


def coloured(fitting: Fitting, fitted: Fitted, noise: Noise, *, named: bool = False) -> Noise:
    """Noise with its colour, from the residual of a model whose initial states are fitted.

    The force of a wire jumps with every command, and a wire that is slightly wrong leaves jumps that look
    like noise which wanders. So what the predicted force itself explains is taken out of its residual; so is
    from any channel what follows its own value, as it does where a sensor saturates. An error that nothing in
    the rig foretells may be noise in the bands in which the rig moves, too; not where effects were added, as
    they may have taken out what would have foretold it. What two channels show is marked as shared.
    """
    evidence, left = fitting.experiment.evidence, left_by(fitting, fitted)
    causes = possible_causes(evidence, evidence.measured - left)

    def of_channel(k: int) -> Colour:
        error, predicted, before = left[:, k], evidence.measured[:, k] - left[:, k], noise.colours[k]
        if evidence.channels[k].family == "force":
            error = _without(error, predicted)
        error = _without_own(error, predicted)
        if np.isfinite(error).mean() < COLOUR_FEWEST_READINGS_SHARE or is_rare(error[np.isfinite(error)]):
            return before
        colour = colour_of(error, evidence.measured[:, k], before.level)
        slow = colour.is_white and not named and slow_power(error / colour.level)[0] > SLOW_POWER_WHITE
        if slow and unrelated(error, causes):
            colour = colour_of(error, evidence.measured[:, k], before.level, moves=False)
        return colour

    colours = fitting.cores.each(of_channel, range(len(evidence.channels)))
    shared = in_common(left, colours, fitting.windows.start)
    return Noise(tuple(replace(one, shared=both) for one, both in zip(colours, shared, strict=True)))


def in_common(errors: Floats, colours: Sequence[Colour], starts: Integers) -> list[bool]:
    """Whether the coloured part of each channel shows in another one as well: then it is motion, not noise.

    Two sensors err independently of each other: at as few as `COHERENT_FREQUENCIES`, their errors are
    coherent by a chance that is known.

    Parameters
    ----------
    errors : (s, k) array
        Measured minus simulated.
    colours : sequence of k Colour
    starts : (w,) array
        First samples of the runs.
    """
    white = whitened_from(np.nan_to_num(errors), colours, starts)
    lines = np.fft.rfft(white - white.mean(axis=0), axis=0)[1:]
    counts = [COHERENT_FREQUENCIES]
    while 8 * counts[-1] <= lines.shape[0]:  # up to a quarter of all
        counts.append(2 * counts[-1])
    return [
        not colour.is_white
        and any(_coherent(lines[:n, [k, j]], n) for j in range(len(colours)) if j != k for n in counts)
        for k, colour in enumerate(colours)
    ]


def _coherent(pair: npt.NDArray[np.complex128], count: int) -> bool:
    """Whether two signals have more in common at some frequencies (n, 2) than chance would have it."""
    power = np.square(np.abs(pair)).sum(axis=0)
    both = float(np.abs(np.vdot(pair[:, 0], pair[:, 1]))) ** 2
    return bool(both > (1.0 - COHERENCE_CHANCE ** (1.0 / (count - 1))) * float(power.prod()))


def left_by(fitting: Fitting, fitted: Fitted) -> Floats:
    """What a fitted model leaves (s, k), in the units of the channels, the initial states fitted, too."""
    plain = replace(fitting, colours=())
    errors = plain.projected(plain.residual(fitted.model)).reshape(fitting.weight.shape)
    with np.errstate(divide="ignore"):
        return errors * np.where(fitting.weight > 0.0, 1.0 / fitting.weight, np.nan)


def _without(error: Floats, force: Floats) -> Floats:
    """Error (s,) without what a force (s,), late or early by some samples, explains of it."""
    known = np.isfinite(error) & np.isfinite(force)
    columns = np.stack([np.roll(np.nan_to_num(force), shift) for shift in FORETELLING_SHIFTS], axis=1)
    sizes = np.linalg.lstsq(columns[known], error[known], rcond=1e-10)[0]
    return np.asarray(error - columns @ sizes)


def _without_own(error: Floats, predicted: Floats) -> Floats:
    """Error (s,) without a curve over the signal's own value, where that foretells it in other stretches."""
    known = np.isfinite(error) & np.isfinite(predicted)
    if np.count_nonzero(known) < OWN_VALUE_LEVELS * OWN_VALUE_LEVELS:
        return error
    edges = np.quantile(predicted[known], np.linspace(0.0, 1.0, OWN_VALUE_LEVELS + 1)[1:-1])
    level = np.searchsorted(edges, predicted)
    even = np.arange(error.size) * OWN_VALUE_STRETCHES // error.size % 2 == 0
    foretold = np.zeros(error.size)
    for these, others in ((even, ~even), (~even, even)):
        foretold[these] = _steps(error, level, known & others)[level[these]]
    left = float(np.sum(np.square(error[known] - foretold[known])))
    if left > (1.0 - OWN_VALUE_SHARE) * float(np.sum(np.square(error[known]))):
        return error
    return np.asarray(error - _steps(error, level, known)[level])


def _steps(error: Floats, level: npt.NDArray[np.intp], known: Flags) -> Floats:
    """Mean error (l,) at each level, 0 where none is known."""
    count = np.bincount(level[known], minlength=OWN_VALUE_LEVELS)
    return np.bincount(level[known], error[known], OWN_VALUE_LEVELS) / np.maximum(count, 1)
