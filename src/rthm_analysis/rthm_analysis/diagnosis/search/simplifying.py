"""Ask of every effect that was added whether it is needed, and whether a plainer one would do."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.search import (
    DISTINGUISHING_GAIN,
    FINISHING_STEPS,
    NEAR_NOISE_CHI2,
    STEPS_WITHOUT_KIND,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.judging import FittedCandidate, Selection, better, merit, reduced_chi2
from rthm_analysis.diagnosis.search.pairing import companions
from rthm_analysis.diagnosis.search.pieces import is_plain
from rthm_analysis.diagnosis.search.replacing import is_identified, model_of, plainer
from rthm_core.errors import InputError


def simplified(fitting: Fitting, selection: Selection) -> Selection:
    """The same, or fewer or plainer effects that predict unseen data as well."""
    needed = _without_the_needless(fitting, selection)
    simpler = _reconsidered(fitting, needed)
    return plainer(fitting, needed if simpler is needed else _without_the_needless(fitting, simpler))


def _without_the_needless(fitting: Fitting, selection: Selection) -> Selection:
    """Leave out effects that only helped the others, or what is uncertain, to find their values."""
    for index in reversed(range(len(selection.rounds))):
        if len(selection.rounds) == 1 and not selection.base.model.parameters:
            break  # nothing else could stand for it
        try:
            others = [(i, tried[0].start) for i, tried in enumerate(selection.rounds) if i != index]
            alone = _by_itself(
                fitting, model_of(selection, others), FINISHING_STEPS if index == 0 else STEPS_WITHOUT_KIND
            )
        except np.linalg.LinAlgError:  # without the effect the model diverges
            continue
        last = selection.rounds[index][0]
        absent = reduced_chi2(fitting, alone) < NEAR_NOISE_CHI2 and is_plain(last.start)
        absent = absent and not is_identified(selection.best, index)
        if not absent and better(FittedCandidate(last.start, selection.best, last.error), alone):
            continue
        rounds = [tried for i, tried in enumerate(selection.rounds) if i != index]
        fitting.reduced_chi2 = reduced_chi2(fitting, alone)
        fewer = Selection(selection.base if rounds else alone, alone, rounds, selection.limits)
        return _without_the_needless(fitting, fewer)
    return selection


def _by_itself(fitting: Fitting, model: Model, most: int) -> Fitted:
    """Fit of a model, with its own sensitivities to the initial states where it is near the noise."""
    fitted = fitting.fit(model, most=most)
    if reduced_chi2(fitting, fitted) > NEAR_NOISE_CHI2:
        return fitted
    with fitting.based_on(fitted.model):
        return fitting.fit(fitted.model, most=STEPS_WITHOUT_KIND)


def _reconsidered(fitting: Fitting, selection: Selection) -> Selection:
    """Look for one companion of each effect that would make the others needless.

    A flexible kind that came first may have imitated what two plain ones do together.
    """
    others = [tried[0] for tried in selection.rounds]
    if len(others) < 2 or not others[0].law.flexible or fitting.reduced_chi2 < _look_elsewhere(fitting):
        return selection
    if len(others) == 2:  # the second was the best companion of the first
        others = others[1:]
    best = selection
    for kept in reversed(others):
        if fitting.budget.spent:
            break
        fitting.progress("looking for a simpler explanation")
        model = kept.start.added_to(selection.base.model)
        try:
            alone = fitting.fit(model)
            tried = companions(fitting, alone)
        except (InputError, np.linalg.LinAlgError):
            continue
        if tried and merit(tried[0].fitted) < merit(best.best) - DISTINGUISHING_GAIN:
            first = FittedCandidate.of(kept.start, alone)
            best = Selection(selection.base, tried[0].fitted, [[first], tried], selection.limits)
            fitting.reduced_chi2 = reduced_chi2(fitting, best.best)
    return best


def _look_elsewhere(fitting: Fitting) -> float:
    """Reduced chi-squared that noise alone leaves in 39 of 40 recordings."""
    return float(1.0 + 2.0 * np.sqrt(2.0 / max(fitting.expected, 1.0)))
