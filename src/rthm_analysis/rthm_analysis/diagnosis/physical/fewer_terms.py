"""Terms of a formula that it does not need: what reaches the noise without them says no more with them."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.search import GAIN_OF_CHANCE, GAIN_PER_PARAMETER
from rthm_analysis.diagnosis.physical.above_noise import without_each
from rthm_analysis.diagnosis.physical.verdict import Judgement


@np.errstate(over="ignore", invalid="ignore")  # a model that diverges is known by its error
def with_fewer_terms(judged: Judgement) -> Judgement:
    """The same without terms whose gain in data left out of the fit may be chance, as long as nothing but
    noise is left.
    """
    while judged.earned and judged.at_noise and judged.physical.selection.formulas > 1:
        fewer = _without_least(judged)
        if fewer is None:
            return judged
        judged = fewer
    return judged


def _without_least(judged: Judgement) -> Judgement | None:
    """The model without the term that is needed least, judged; None where that is needed."""
    physical, selection = judged.physical, judged.physical.selection
    count = len(selection.rounds)
    terms = range(count - selection.formulas, count)
    tried = [without_each(physical, [index]) for index in terms]
    tried = [one for one in tried if len(one.selection.rounds) < count]
    if not tried:
        return None
    least = min(tried, key=lambda one: one.selection.left_out)
    numbers = len(selection.best.model.parameters) - len(least.selection.best.model.parameters)
    if not least.selection.left_out - selection.left_out < GAIN_OF_CHANCE + GAIN_PER_PARAMETER * numbers:
        return None
    fewer = judged.of(least, composed=judged.composed)
    return fewer if fewer.earned and fewer.at_noise else None
