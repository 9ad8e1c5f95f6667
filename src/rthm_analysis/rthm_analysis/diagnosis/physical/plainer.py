"""A plainer hypothesis than missing physics: other values of mass, damping, stiffness, wire, by entries.

What a spec does not call uncertain it calls exact, and it may be wrong all the same.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.criteria.search import (
    FINISHING_GAIN,
    FINISHING_STEPS,
    GAIN_OF_CHANCE,
    GAIN_PER_PARAMETER,
    NEAR_NOISE_CHI2,
)
from rthm_analysis.diagnosis.criteria.verdict import STEPS_WITHOUT_VALUE
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.physical.beginning import Baseline, best_of_starts, fitted_near
from rthm_analysis.diagnosis.replay.entries import entry_of, free_entries
from rthm_analysis.diagnosis.replay.model import PROPERTIES, Model, Parameter
from rthm_analysis.diagnosis.search.judging import Selection, clear_gain, reduced_chi2
from rthm_analysis.diagnosis.search.replacing import rounds_refitted


def freed(fitting: Fitting, model: Model) -> Model:
    """Model with every entry of mass, damping, stiffness and wire free, whatever the spec says of it."""
    evidence, spec = fitting.experiment.evidence, model.nominal
    commanded = evidence.driven_by == "command"
    frequency = 2.0 * np.pi / evidence.period
    entries = free_entries(spec, frequency, commanded=commanded, forced=evidence.is_forced)
    others = tuple(p for p in model.parameters if p.key not in PROPERTIES and entry_of(p.key) is None)
    return replace(model, parameters=(*others, *entries))


def plain_fit(fitting: Fitting, begun: Baseline, near: Fitted | None = None) -> Fitted:
    """Fit of all entries, begun from `near` where short runs have shown about where they are."""
    fitting.progress("trying other values of mass, damping and stiffness")
    before = fitting.reduced_chi2
    fitting.reduced_chi2 = reduced_chi2(fitting, begun.retuned)
    start = near.model if near is not None else freed(fitting, begun.nominal.model)
    try:
        found = fitted_near(fitting, best_of_starts(fitting, start))
        if reduced_chi2(fitting, found) < NEAR_NOISE_CHI2:
            fitting.reduced_chi2 = reduced_chi2(fitting, found)
            fitting.rebase(found.model)
            found = fitting.fit(found.model, most=FINISHING_STEPS, least=FINISHING_GAIN)
    except np.linalg.LinAlgError:
        fitting.reduced_chi2 = before
        return begun.retuned
    fitting.reduced_chi2 = reduced_chi2(fitting, found)
    return found


def needed_only(fitting: Fitting, selection: Selection) -> Selection:
    """Return values to those of the spec where unseen data are predicted as well with them."""
    best, base = selection.best, selection.base
    for key in [p.key for p in best.model.parameters if entry_of(p.key) is not None and p.prior is None]:
        try:
            without = fitting.fit(_without(best.model, key), most=STEPS_WITHOUT_VALUE)
        except np.linalg.LinAlgError:
            continue
        if not clear_gain(without, best, GAIN_OF_CHANCE + GAIN_PER_PARAMETER):
            best = without
            base = replace(base, model=_without(base.model, key))
    if best is selection.best:
        return selection
    try:
        best = fitting.fit(best.model, most=FINISHING_STEPS, least=FINISHING_GAIN)
        base = best if not selection.rounds else fitting.fit(base.model, most=STEPS_WITHOUT_VALUE)
    except np.linalg.LinAlgError:
        return selection
    fitting.reduced_chi2 = reduced_chi2(fitting, best)
    return rounds_refitted(fitting, Selection(base, best, selection.rounds, selection.limits))


def _without(model: Model, key: str) -> Model:
    """Model in which an entry has the value of the spec; what moves along with others keeps its partner."""
    place = [p.key for p in model.parameters].index(key)
    kept = tuple(_moved_up(p, place) for i, p in enumerate(model.parameters) if i != place)
    return replace(model, parameters=kept)


def _moved_up(parameter: Parameter, gone: int) -> Parameter:
    along = parameter.along
    return parameter if along is None or along < gone else replace(parameter, along=along - 1)
