"""How far ahead a fitted model tells a motion: where neighbouring motions part, only in short runs."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import FINE_FIT_GAIN
from rthm_analysis.diagnosis.criteria.search import FINISHING_STEPS, NEAR_NOISE_CHI2
from rthm_analysis.diagnosis.criteria.verdict import PREDICTION_SPREAD
from rthm_analysis.diagnosis.fitting.fitting import Fitted, bounded
from rthm_analysis.diagnosis.physical.beginning import Baseline, in_short_runs
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.judging import Selection, reduced_chi2
from rthm_analysis.diagnosis.search.replacing import rounds_refitted


def foreseen(
    begun: Baseline, selection: Selection, seen: Evidence, settled: Model, whole: Experiment
) -> tuple[Baseline, Selection]:
    """The same, or in short runs where a model that is at the noise cannot tell the unseen part in one run.

    Parameters
    ----------
    begun : Baseline
    selection : Selection
        Found in `begun`.
    seen : Evidence
    settled : Model
    whole : Experiment
        Over the whole recording. Nothing that was measured in its unseen part is looked at.
    """
    fitting, best = begun.fitting, selection.best
    if not selection.rounds or begun.runs.length is not None or reduced_chi2(fitting, best) > NEAR_NOISE_CHI2:
        return begun, selection
    train = fitting.measured.shape[0]
    if _spread(begun, best, whole, train) < PREDICTION_SPREAD:
        return begun, selection
    short = in_short_runs(begun, seen, settled, train)
    try:
        fitted = short.fitting.fit(best.model, most=FINISHING_STEPS, least=FINE_FIT_GAIN)
        short.fitting.reduced_chi2 = reduced_chi2(short.fitting, fitted)
        again = rounds_refitted(
            short.fitting, Selection(short.retuned, fitted, selection.rounds, selection.limits)
        )
    except np.linalg.LinAlgError:
        return begun, selection
    return (short, again) if short.fitting.reduced_chi2 < NEAR_NOISE_CHI2 else (begun, selection)


def _spread(begun: Baseline, best: Fitted, whole: Experiment, train: int) -> float:
    """Standard deviation of what a fitted model predicts of unseen data, root mean square over the noise."""
    runs, model = begun.fitting.corrected(begun.runs, best), best.model
    here = whole.predicted(model.spec, runs)
    size, directions = np.linalg.eigh(np.nan_to_num(best.sums.covariance()))
    squares = np.zeros(here[train:].shape)
    for std, direction in zip(np.sqrt(np.maximum(size, 0.0)), directions.T, strict=True):
        there = whole.predicted(model.at(model.values + std * direction).spec, runs)
        squares += np.square(bounded((there - here)[train:] / begun.noise.level))
    return float(np.sqrt(squares.mean()))
