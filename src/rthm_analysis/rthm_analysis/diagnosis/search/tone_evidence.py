"""What a tone has to show beyond its gain: with size, frequency and phase it imitates whatever is periodic.

A force from outside keeps its size and phase from the first part of a recording to the last. What is wrong
with the model of the rig itself does not: it follows the motion. That is largest at the frequencies of the
known loads and of the rig, and there a tone says least.
"""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.search import (
    LOAD_LINE_SHARE,
    RINGING_SHARE,
    TONE_AGREEMENT,
    TONE_AGREEMENT_AT_RIG,
    TONE_AGREEMENT_STDS,
    TONE_PARTS,
    TONE_RESOLUTION,
    TONE_RIVAL_SHARE,
    TONE_RIVAL_SHARE_AT_RIG,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.mechanics import mechanics, state_matrix
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.judging import FittedCandidate, reduced_chi2
from rthm_analysis.diagnosis.search.scene import seen_in
from rthm_core.compiled import Floats


def without_unproven_tones(
    fitting: Fitting, tried: list[FittedCandidate], without: Fitted
) -> list[FittedCandidate]:
    """Leave out tones that do not last, and put other kinds before those that they do nearly as well as.

    Parameters
    ----------
    fitting : Fitting
    tried : list of FittedCandidate
        Best first.
    without : Fitted
        Model to which they were added.
    """
    lasting = [one for one in tried if not one.law.is_tone or lasts(fitting, one.fitted, -1)]
    if not lasting or not lasting[0].law.is_tone:
        return lasting
    before = float(without.left_out.sum())
    share = (
        TONE_RIVAL_SHARE_AT_RIG if _says_little(fitting, lasting[0].fitted.model, -1) else TONE_RIVAL_SHARE
    )
    enough = share * (before - lasting[0].error)
    instead = [one for one in lasting if not one.law.is_tone and before - one.error > enough]
    first = instead[0] if instead else None
    return [*instead[:1], *(one for one in lasting if one is not first)]


def lasts(fitting: Fitting, fitted: Fitted, index: int) -> bool:
    """Whether all parts of the data agree on size and phase of an added tone; -1: of the last."""
    index %= len(fitted.model.added)
    allowed = TONE_AGREEMENT_AT_RIG if _says_little(fitting, fitted.model, index) else TONE_AGREEMENT
    return bool(np.all(_differences(fitting, fitted, index) < allowed))


def _differences(fitting: Fitting, fitted: Fitted, index: int) -> Floats:
    """By how much each part wants another size or phase of the tone, beyond three standard deviations."""
    model, sums = fitted.model, fitted.sums
    places = model.places(index)
    own = [places["amplitude"], places["phase"]]
    scale = np.array([model.parameters[own[0]].value, 1.0])
    found = []
    for part in np.array_split(np.arange(sums.squares.size), TONE_PARTS):
        matrix = sums.hessian[part].sum(0)[np.ix_(own, own)] * np.outer(scale, scale)
        inverse = np.linalg.pinv(matrix, hermitian=True)
        wanted = inverse @ (scale * sums.gradient[part].sum(0)[own])
        std = np.sqrt(reduced_chi2(fitting, fitted) * np.maximum(np.diag(inverse), 0.0))
        found.append(float(np.max(np.abs(wanted) - TONE_AGREEMENT_STDS * std)))
    return np.array(found)


def _says_little(fitting: Fitting, model: Model, index: int) -> bool:
    """Whether a tone is at a frequency of the known loads or of the rig itself, or beside another tone."""
    if sum(one.law.is_tone for one in model.added) > 1:
        return True
    frequency = float(model.effect_values(index % len(model.added))["frequency"])
    evidence = fitting.experiment.evidence
    width = TONE_RESOLUTION * seen_in(evidence.time).frequencies[0]
    rig = np.abs(np.linalg.eigvals(state_matrix(mechanics(fitting.base.spec))))
    driven = np.abs(load_lines(evidence) - frequency) < width
    return bool(driven.any() or (np.abs(rig - frequency) < np.maximum(RINGING_SHARE * rig, width)).any())


def load_lines(evidence: Evidence) -> Floats:
    """Frequencies at which the known loads act most, rad/s."""
    time = evidence.time
    step = float(np.median(np.diff(time)))
    even = np.arange(time[0], time[-1], step)
    omega = 2.0 * np.pi * np.fft.rfftfreq(even.size, step)
    found = []
    for load in evidence.load.T:
        size = np.abs(np.fft.rfft(np.interp(even, time, load - load.mean())))
        found.append(omega[size > LOAD_LINE_SHARE * size.max()] if size.max() > 0.0 else omega[:0])
    return np.concatenate(found)
