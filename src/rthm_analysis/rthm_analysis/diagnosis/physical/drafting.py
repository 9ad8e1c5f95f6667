"""A draft of the search, on fewer samples and in coarser steps, and its fair copy.

Far from the noise, the samples of a test that is sampled often say what their neighbours say. What a search
among some of them finds is fitted to all of them, and the search goes on there where it came near the noise.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import FINE_FIT_GAIN, POOR_FIT_CHI2
from rthm_analysis.diagnosis.criteria.search import FINISHING_STEPS
from rthm_analysis.diagnosis.criteria.verdict import (
    DRAFT_FEWEST_IN_WINDOW,
    DRAFT_FEWEST_SAMPLES,
    DRAFT_KINDS_COPIED,
    DRAFT_LEAST_EXCESS,
    DRAFT_MOST_APART,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.physical.beginning import Baseline
from rthm_analysis.diagnosis.search.choosing import choose
from rthm_analysis.diagnosis.search.judging import FittedCandidate, Selection, reduced_chi2
from rthm_analysis.diagnosis.search.refining import fit_further, unfitted


class Draft(NamedTuple):
    """Fits on one of `every` samples, and the retuned model fitted there."""

    fitting: Fitting
    every: int
    retuned: Fitted


def drafted(begun: Baseline, draft: Draft, stop: Callable[[float], bool]) -> Selection | None:
    """What a search finds in a draft, fitted to everything; None where the draft misled.

    Parameters
    ----------
    begun : Baseline
        Its fitting has the reduced chi-squared of the retuned model.
    draft : Draft
        Of it.
    stop : callable
        As in `choose`.
    """
    draft.fitting.reduced_chi2 = reduced_chi2(draft.fitting, draft.retuned)
    return _copied(begun, draft, choose(draft.fitting, draft.retuned, stop))


def draft_of(begun: Baseline) -> Draft | None:
    """Fits on some of the samples; None where that is not called for, or the retuned model diverges."""
    fitting, every = begun.fitting, _every(begun)
    if every < 2:
        return None
    kept, windows = fitting.windows.every(every, fitting.experiment.evidence.stamps_ns.size)
    there = Fitting(
        fitting.experiment.draft(kept), windows, begun.noise.level, fitting.base, fitting.progress,
        reduced_chi2=fitting.reduced_chi2, cores=fitting.cores, asked=fitting.asked, simple=fitting.simple,
    )  # fmt: skip
    try:
        return Draft(there, every, there.fit(begun.retuned.model))
    except np.linalg.LinAlgError:
        return None


def _every(begun: Baseline) -> int:
    """Of how many samples a draft takes one; 1 where it would save nothing, or not be the same test."""
    fitting = begun.fitting
    samples = fitting.experiment.evidence.stamps_ns.size
    shortest = int(np.diff(np.append(fitting.windows.start, samples)).min())
    excess = (fitting.reduced_chi2 - 1.0) * fitting.expected
    fewest = min(
        samples // DRAFT_FEWEST_SAMPLES, shortest // DRAFT_FEWEST_IN_WINDOW, excess // DRAFT_LEAST_EXCESS
    )
    return int(min(fewest, DRAFT_MOST_APART))


def _copied(begun: Baseline, draft: Draft, found: Selection) -> Selection | None:
    """The selection of a draft, with the fits of all samples; None where these say something else."""
    fitting = begun.fitting
    limits = {
        label: {name: float(size / np.sqrt(draft.every)) for name, size in sizes.items()}
        for label, sizes in found.limits.items()
    }
    if not found.rounds:
        return Selection(begun.retuned, begun.retuned, [], limits)
    fitting.progress("fitting what was found to all samples")
    before, fitting.reduced_chi2 = fitting.reduced_chi2, draft.fitting.reduced_chi2
    try:
        fitting.rebase(found.best.model)
        whole = fitting.fit(found.best.model, most=FINISHING_STEPS, least=FINE_FIT_GAIN, affordable=True)
        near = reduced_chi2(fitting, whole) < POOR_FIT_CHI2
        if near and fitting.experiment.sharpen(whole.model.spec):
            whole = fitting.fit(whole.model, most=FINISHING_STEPS, least=FINE_FIT_GAIN, affordable=True)
        copied, copy = DRAFT_KINDS_COPIED if near else 1, partial(_copy, fitting)
        rounds = [
            [one for one in fitting.cores.each_in_parts(copy, tried[:copied]) if np.isfinite(one.error)]
            for tried in found.rounds
        ]
    except np.linalg.LinAlgError:
        fitting.reduced_chi2 = before
        return None
    fitting.reduced_chi2 = reduced_chi2(fitting, whole)
    if not all(rounds):
        return None
    scores = [replace(one, gain=one.gain * draft.every) for one in found.scores]
    return Selection(begun.retuned, whole, rounds, limits, scores=scores)


def _copy(fitting: Fitting, tried: FittedCandidate) -> FittedCandidate:
    """A candidate fitted to all samples from where the draft left it; its error is inf where it diverges."""
    return fit_further(fitting, unfitted(tried.start, tried.fitted, tried.fitted.model), None, 1)
