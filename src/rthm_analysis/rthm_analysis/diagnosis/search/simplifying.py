"""Ask of every effect that was added whether it is needed, and whether a plainer one would do."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.judging import CLOSE, Choice, Tried, better, doubt
from rthm_analysis.diagnosis.search.pieces import is_plain
from rthm_analysis.diagnosis.search.refining import FINISHING
from rthm_analysis.diagnosis.search.replacing import is_identified, model_of, plainer

PRUNING = 8
"""Steps of a fit without an effect that may be needless."""


def simplified(fitting: Fitting, choice: Choice) -> Choice:
    """The same, or fewer or plainer effects that predict unseen data as well."""
    return plainer(fitting, _without_the_needless(fitting, choice))


def _without_the_needless(fitting: Fitting, choice: Choice) -> Choice:
    """Leave out effects that only helped the others, or what is uncertain, to find their values."""
    for index in reversed(range(len(choice.rounds))):
        if len(choice.rounds) == 1 and not choice.base.model.parameters:
            break  # nothing else could stand for it
        try:
            others = [(i, tried[0].start) for i, tried in enumerate(choice.rounds) if i != index]
            alone = _by_itself(fitting, model_of(choice, others), FINISHING if index == 0 else PRUNING)
        except np.linalg.LinAlgError:  # without the effect the model diverges
            continue
        last = choice.rounds[index][0]
        absent = doubt(fitting, alone) < CLOSE and is_plain(last.start)
        absent = absent and not is_identified(choice.best, index)
        if not absent and better(Tried(last.start, choice.best, last.error), alone):
            continue
        rounds = [tried for i, tried in enumerate(choice.rounds) if i != index]
        fitting.doubt = doubt(fitting, alone)
        fewer = Choice(choice.base if rounds else alone, alone, rounds, choice.limits)
        return _without_the_needless(fitting, fewer)
    return choice


def _by_itself(fitting: Fitting, model: Model, most: int) -> Fitted:
    """Fit of a model, with its own sensitivities to the initial states where it is near the noise."""
    fitted = fitting.fit(model, most=most)
    if doubt(fitting, fitted) > CLOSE:
        return fitted
    with fitting.based_on(fitted.model):
        return fitting.fit(fitted.model, most=PRUNING)
