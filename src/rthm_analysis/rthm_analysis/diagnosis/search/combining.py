"""Combinations of kinds that do better than what was found one by one.

One kind can nearly do what two others do together: Stribeck's friction that falls with speed is dry friction
with less drag. Effects that are added one at a time then stop on a ridge. So what was found is asked as a
whole. Near the recording, forces that are the same along the motion stand for each other without any change
of it, so that the sensitivities of the present model tell what every combination would leave.
"""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.search import (
    COMBINATION_BEHIND_RATIO,
    COMBINATION_FIRST_STEPS,
    COMBINATIONS_IN_TURN,
    DISTINGUISHING_GAIN,
    NEAR_NOISE_CHI2,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.judging import (
    FittedCandidate,
    Selection,
    noise_and_no_more,
    price,
    reduced_chi2,
)
from rthm_analysis.diagnosis.search.pieces import Piece, is_plain
from rthm_analysis.diagnosis.search.refining import finished, finished_by_itself, fit_further, unfitted
from rthm_analysis.diagnosis.search.replacing import beside_base, is_identified, rounds_refitted
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_analysis.diagnosis.search.subsets import promised
from rthm_analysis.diagnosis.search.tone_evidence import lasts


def combined(fitting: Fitting, selection: Selection, turns: int = COMBINATIONS_IN_TURN) -> Selection:
    """Leave what was found for another combination that predicts unseen data clearly better, in turns."""
    for again in range(turns):
        spent = fitting.budget.spent and (again > 0 or fitting.reduced_chi2 > NEAR_NOISE_CHI2)
        asks = _questionable(fitting, selection) and not spent
        other = _other(fitting, selection) if asks else None
        if other is None:
            break
        selection = other
    return selection


def _questionable(fitting: Fitting, selection: Selection) -> bool:
    """Whether another combination may do better: not where one plain effect leaves noise and no more."""
    starts = [tried[0].start for tried in selection.rounds]
    alone = len(starts) == 1 and is_plain(starts[0])
    return bool(starts) and not (alone and reduced_chi2(fitting, selection.best) < noise_and_no_more(fitting))


def _cost(fitting: Fitting, selection: Selection, fitted: Fitted) -> float:
    """Squared error on data left out, with what effects and their parameters have to bring."""
    parameters = len(fitted.model.parameters) - len(selection.base.model.parameters)
    return float(fitted.left_out.sum()) + fitting.reduced_chi2 * price(len(fitted.model.added), parameters)


def _other(fitting: Fitting, selection: Selection) -> Selection | None:
    """The best other combination; None where the present one is as good."""
    fitting.progress("looking for a combination that does better")
    least = _cost(fitting, selection, selection.best) - DISTINGUISHING_GAIN * fitting.reduced_chi2
    found = None
    try:
        asked = promised(fitting, selection)
    except np.linalg.LinAlgError:
        return None
    for labels, pieces in asked.items():
        if fitting.budget.spent:
            break
        fitting.asked.add(labels)
        fitted = _fitted(fitting, selection, pieces, least)
        if fitted is not None and _cost(fitting, selection, fitted) < least:
            found, least = (pieces, fitted), _cost(fitting, selection, fitted)
            if reduced_chi2(fitting, fitted) < NEAR_NOISE_CHI2:
                break
    try:
        return _chosen(fitting, selection, *found) if found else None
    except np.linalg.LinAlgError:  # it only stands as a whole
        return None


def _model(selection: Selection, pieces: list[Piece]) -> Model:
    """A combination beside what is uncertain; what is there now has the values it has now."""
    best = selection.best.model
    starts = (
        one.start if one.index is None else one.start.having(best.effect_values(one.index)) for one in pieces
    )
    return beside_base(selection, starts)


def _fitted(fitting: Fitting, selection: Selection, pieces: list[Piece], least: float) -> Fitted | None:
    """A combination, fitted to its end.

    None where it diverges, stays far behind what is to be beaten (`least`), has a plain kind that may as well
    be absent, or a tone that does not last.
    """
    begun = unfitted(pieces[-1].start, selection.best, _model(selection, pieces))
    begun = fit_further(fitting, begun, None, COMBINATION_FIRST_STEPS, affordable=True)
    ahead = least - fitting.expected
    if (
        not np.isfinite(begun.error)
        or _cost(fitting, selection, begun.fitted) > least + (COMBINATION_BEHIND_RATIO - 1.0) * ahead
    ):
        return None
    done = finished_by_itself(fitting, begun)
    tones = [i for i, one in enumerate(pieces) if one.start.added.law.is_tone]
    if not np.isfinite(done.error) or not all(lasts(fitting, done.fitted, i) for i in tones):
        return None
    plain = [i for i, one in enumerate(pieces) if is_plain(one.start)]
    # Far from the noise, the standard deviations are those of what is left.
    far = reduced_chi2(fitting, done.fitted) > NEAR_NOISE_CHI2
    return done.fitted if far or all(is_identified(done.fitted, i) for i in plain) else None


def _rebased(fitting: Fitting, fitted: Fitted, last: InitialGuess) -> Fitted:
    """The same fitted again, with the sensitivities to the initial states of a model that is nearer."""
    fitting.reduced_chi2 = reduced_chi2(fitting, fitted)
    fitting.experiment.sharpen(fitted.model.spec)
    fitting.rebase(fitted.model)
    again = finished(fitting, unfitted(last, fitted, fitted.model), affordable=True)
    return again.fitted if np.isfinite(again.error) else fitted


def _chosen(fitting: Fitting, selection: Selection, pieces: list[Piece], fitted: Fitted) -> Selection:
    """A combination as a selection: its effects one by one, beside the kinds that were compared with them."""
    fitted = _rebased(fitting, fitted, pieces[-1].start)
    others = {tried[0].label: tried[1:] for tried in selection.rounds}
    last = selection.rounds[-1][0]
    error = float(fitted.left_out.sum())
    rounds = [[FittedCandidate(one.start, fitted, error), *others.get(one.start.label, [])] for one in pieces]
    if last.label not in {one.start.label for one in pieces}:
        rounds[-1].append(FittedCandidate(last.start, selection.best, last.error))
    return rounds_refitted(fitting, Selection(selection.base, fitted, rounds, selection.limits))
