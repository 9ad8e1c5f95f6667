"""Whether a fitted model leaves nothing but noise of the training part."""

from __future__ import annotations

from rthm_analysis.diagnosis.criteria.search import NEAR_NOISE_CHI2
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.physical.remainder import slow_power, tolerance
from rthm_analysis.diagnosis.search.judging import Selection, reduced_chi2


def at_noise(fitting: Fitting, fitted: Fitted) -> bool:
    """Whether a model leaves nothing but noise of the training part."""
    if reduced_chi2(fitting, fitted) > NEAR_NOISE_CHI2:
        return False
    errors = fitting.projected(fitting.residual(fitted.model)).reshape(-1, fitting.channels)
    return all(
        slow_power(column)[0] < tolerance(white)
        for column, white in zip(errors.T, fitting.whites, strict=True)
    )


def explained_by_kinds(fitting: Fitting, selection: Selection) -> bool:
    """Whether known kinds of physics, and no formula, leave nothing but noise of the training part."""
    return len(selection.rounds) > selection.formulas == 0 and at_noise(fitting, selection.best)
