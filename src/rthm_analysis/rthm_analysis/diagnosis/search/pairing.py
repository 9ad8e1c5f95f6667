"""Look for effects that go together: of two that are both large, neither explains much alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.fitting.fitting import WRONG, Fitted, Fitting
from rthm_analysis.diagnosis.search.judging import FLEXIBLE, Choice, Tried, doubt, in_order
from rthm_analysis.diagnosis.search.promising import promising, screened
from rthm_analysis.diagnosis.search.refining import finished, fit_further, refined, unfitted
from rthm_analysis.diagnosis.search.told_wires import released, told_wire

PAIRED = 3
"""Plain kinds for which a companion is looked for where no single kind comes near the noise."""

TOGETHER = 8
"""Steps of a fit of two effects that were found apart."""


def companions(fitting: Fitting, fitted: Fitted) -> list[Tried]:
    """What goes best with the effects that a model has, refined, best first."""
    known = fitting.known(fitted)
    return refined(fitting, fitted, known, promising(screened(fitting, fitted, known)))


def paired(fitting: Fitting, base: Fitted, tried: list[Tried]) -> list[list[Tried]]:
    """Two rounds in which a plain kind and a companion come near the noise that no single kind came near.

    Parameters
    ----------
    fitting : Fitting
    base : Fitted
        Model without both.
    tried : list of Tried
        All that the first was chosen from. A companion is looked for those that are plain: a flexible kind
        imitates both.
    """
    for first in [one for one in tried if one.label[1] not in FLEXIBLE][:PAIRED]:
        if fitting.budget.spent:
            break
        fitting.progress(f"looking for what goes with {first.label[1]}")
        found = companions(fitting, first.fitted)
        if found and doubt(fitting, found[0].fitted) < WRONG:
            fitting.doubt = doubt(fitting, found[0].fitted)
            fitting.rebase(found[0].fitted.model)
            found[0] = finished(fitting, let_go(found[0], base))
            return [[first, *(one for one in tried if one is not first)], found]
    return []


def led_by_a_wire(fitting: Fitting, base: Fitted) -> Choice | None:
    """What the own force of a wire tells, with what goes best beside it.

    Its values stay where that force wants them until the model is near the recording: alone it may be further
    away than without.

    Returns
    -------
    Choice or None
        None where no force tells, the model is near without, or one effect of another kind does better.
    """
    found = told_wire(fitting, base) if fitting.doubt > WRONG else None
    if found is None:
        return None
    start, model = found
    fitting.told[start.added.place] = start.added.kind
    told = fit_further(fitting, unfitted(start, base, model), None, 1)
    if doubt(fitting, told.fitted) < WRONG:
        return _begun_with(fitting, base, [told])
    fitting.progress(f"looking for what goes with {told.label[1]}")
    singles = [one for one in companions(fitting, base) if one.label[0] != "wire"]
    beside = [_beside(fitting, base, told, one) for one in singles[:PAIRED]]
    if not any(doubt(fitting, one.fitted) < WRONG for one in beside):
        fitting.rebase(told.fitted.model)
        beside += companions(fitting, told.fitted)
        fitting.rebase(base.model)
    best = min(in_order(beside)[:1] + singles[:1], key=lambda one: one.error, default=None)
    return None if best is None or best in singles else _begun_with(fitting, base, [told, best])


def _beside(fitting: Fitting, base: Fitted, told: Tried, single: Tried) -> Tried:
    """An effect that was found alone, fitted beside what the force of a wire told."""
    values, alone = told.fitted.model.values, single.fitted.model
    own = len(base.model.parameters)
    values[:own] = alone.values[:own]
    added = replace(single.start.added, parameters=alone.effect_values(len(alone.added) - 1))
    start = replace(single.start, added=added)
    model = start.added_to(told.fitted.model.at(values))
    with fitting.based_on(model):
        return fit_further(fitting, unfitted(start, told.fitted, model), None, TOGETHER)


def _begun_with(fitting: Fitting, base: Fitted, found: list[Tried]) -> Choice:
    """Choice that begins with these effects, fitted to their end where they are near the recording."""
    last = found[-1]
    fitting.doubt = doubt(fitting, last.fitted)
    fitting.rebase(last.fitted.model)
    if fitting.doubt < WRONG:
        last = finished(fitting, let_go(last, base))
    return Choice(base, last.fitted, [[one] for one in (*found[:-1], last)])


def let_go(tried: Tried, base: Fitted) -> Tried:
    """The same, with the values of all effects left to the recording as a whole."""
    model = released(tried.fitted.model, len(base.model.parameters))
    return replace(tried, fitted=replace(tried.fitted, model=model, settled=np.inf))
