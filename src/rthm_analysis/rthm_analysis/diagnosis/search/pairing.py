"""Look for effects that go together: of two that are both large, neither explains much alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import POOR_FIT_CHI2
from rthm_analysis.diagnosis.criteria.search import PAIRED_KINDS
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.search.judging import FittedCandidate, reduced_chi2
from rthm_analysis.diagnosis.search.promising import promising, screened
from rthm_analysis.diagnosis.search.refining import finished, refined
from rthm_analysis.diagnosis.search.wire_from_force import released


def companions(fitting: Fitting, fitted: Fitted) -> list[FittedCandidate]:
    """What goes best with the effects that a model has, refined, best first."""
    known = fitting.known(fitted)
    return refined(fitting, fitted, known, promising(screened(fitting, fitted, known)))


def paired(fitting: Fitting, base: Fitted, tried: list[FittedCandidate]) -> list[list[FittedCandidate]]:
    """Two rounds in which a plain kind and a companion come near the noise that no single kind came near.

    Parameters
    ----------
    fitting : Fitting
    base : Fitted
        Model without both.
    tried : list of FittedCandidate
        All that the first was chosen from. A companion is looked for those that are plain: a flexible kind
        imitates both.
    """
    for first in [one for one in tried if not one.law.flexible][:PAIRED_KINDS]:
        if fitting.budget.spent:
            break
        fitting.progress(f"looking for what goes with {first.label[1]}")
        found = companions(fitting, first.fitted)
        if found and reduced_chi2(fitting, found[0].fitted) < POOR_FIT_CHI2:
            fitting.reduced_chi2 = reduced_chi2(fitting, found[0].fitted)
            fitting.rebase(found[0].fitted.model)
            found[0] = finished(fitting, let_go(found[0], base))
            return [[first, *(one for one in tried if one is not first)], found]
    return []


def let_go(tried: FittedCandidate, base: Fitted) -> FittedCandidate:
    """The same, with the values of all effects left to the recording as a whole."""
    model = released(tried.fitted.model, len(base.model.parameters))
    return replace(tried, fitted=replace(tried.fitted, model=model, settled=np.inf))
