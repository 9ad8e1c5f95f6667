"""Kinds of the library beside a formula: with the formula in the spec, the search begins anew.

A large force that no kind fits hides what else is missing. Once a formula tells it, the rest can be named.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from rthm_analysis.diagnosis.criteria.missing import (
    BESIDE_FIT_BUDGET,
    FORMULA_SIZE_UNCERTAINTY,
)
from rthm_analysis.diagnosis.criteria.verdict import LOST_CHI2
from rthm_analysis.diagnosis.physical.above_noise import without_each
from rthm_analysis.diagnosis.physical.composing import with_formulas
from rthm_analysis.diagnosis.physical.confirming import confirmed
from rthm_analysis.diagnosis.physical.fewer import judged_of, with_fewer
from rthm_analysis.diagnosis.physical.formula_model import with_all
from rthm_analysis.diagnosis.physical.side import Physical, diagnose_physical
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.judging import reduced_chi2
from rthm_analysis.diagnosis.search.replacing import rounds_refitted
from rthm_core.effects.formula import NUMBERS
from rthm_core.spec import Spec, apply


def with_kinds(judged: Judgement) -> Judgement:
    """The model with a formula and with kinds that are found beside it, judged; as it was where there are
    none, or unseen data do not confirm them.
    """
    physical, selection = judged.physical, judged.physical.selection
    alone = selection.formulas == len(selection.rounds) == 1
    lasting = not any("t" in one.law.depends_on for one in selection.best.model.added if one.law.written)
    if not (alone and lasting) or reduced_chi2(physical.fitting, selection.best) < LOST_CHI2:
        return judged
    physical.fitting.progress("looking for kinds beside the formula")
    found = _found_beside(physical)
    if not found.selection.rounds or found.selection.formulas:
        return judged
    kinds = [tried[0].start.having(_values(found, i)) for i, tried in enumerate(found.selection.rounds)]
    terms = [tried[0].start.having(_values(physical, i, found)) for i, tried in enumerate(selection.rounds)]
    physical.fitting.budget.allow(BESIDE_FIT_BUDGET)
    base = _without_effects(selection.base.model, found.selection.best.model)
    both = with_formulas(
        judged, selection.base, with_all(base, [*kinds, *terms]), terms, found.selection.rounds
    )
    if both is None or both.squares["explained"] >= judged.squares["explained"]:
        return judged
    return _confirmed_beside(both)


def each_by_itself(judged: Judgement) -> Judgement:
    """The same with what each kind beside a formula explains before the others: all were fitted together."""
    physical, selection = judged.physical, judged.physical.selection
    if judged.at_noise or not len(selection.rounds) > selection.formulas > 0:
        return judged
    refitted = rounds_refitted(physical.fitting, selection)
    return Judgement(replace(physical, selection=refitted), judged.runs, judged.composed)


def _confirmed_beside(judged: Judgement) -> Judgement:
    """The same without kinds beside the formula without which unseen data are predicted as well: they made up
    for a term that bends otherwise.
    """
    kinds = len(judged.physical.selection.rounds) - judged.physical.selection.formulas
    for index in reversed(range(kinds)):
        without = without_each(judged.physical, [index])
        if len(without.selection.rounds) == len(judged.physical.selection.rounds):
            continue
        fewer = judged.of(without, composed=True)
        if fewer.squares["explained"] <= judged.squares["explained"]:
            judged = fewer
    return judged


def _found_beside(physical: Physical) -> Physical:
    """What is found with the formula in the spec, without what unseen data deny."""
    spec, first = _with_formula(physical), physical.experiment.first
    found = diagnose_physical(physical.evidence, spec, first, physical.fitting.progress, formula=False)
    found, _ = confirmed(found)
    found, judged, _ = with_fewer(found, judged_of(found))
    return found if judged.earned else replace(found, selection=replace(found.selection, rounds=[]))


def _with_formula(physical: Physical) -> Spec:
    """The spec with the terms of a formula, whose sizes are uncertain."""
    model = physical.selection.best.model
    names = [model.name(index) for index in range(len(model.added))]
    changes: dict[str, Any] = {"effects": [*(e.name for e in physical.settled.effects), *names]}
    for index, (name, one) in enumerate(zip(names, model.added, strict=True)):
        uncertain = {"uncertainty": {NUMBERS[0]: FORMULA_SIZE_UNCERTAINTY}}
        changes[name] = one.section(model.effect_values(index)) | uncertain
    return apply(physical.settled, changes)


def _values(physical: Physical, index: int, found: Physical | None = None) -> dict[str, float | str]:
    """Values of an effect that was added; of a term those that it has beside what was found."""
    model = physical.selection.best.model
    values = model.effect_values(index)
    if found is not None:
        name = f"{model.name(index)}."
        beside = {p.key: p.value for p in found.selection.best.model.parameters}
        values |= {key: beside[name + key] for key in values if name + key in beside}
    return values


def _without_effects(base: Model, found: Model) -> Model:
    """A model with what was retuned in another one, whose effects are no part of it."""
    known = {one.name for one in base.nominal.effects}
    added = {one.name for one in found.spec.effects} - known
    kept = [p for p in found.parameters if p.key.partition(".")[0] not in added]
    return replace(base, parameters=tuple(kept), added=())
