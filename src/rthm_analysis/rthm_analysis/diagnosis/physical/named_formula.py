"""A formula each of whose terms is the law of a kind: its names are told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import FORMULA_FIT_STEPS, SAME_LAW_SAMPLES
from rthm_analysis.diagnosis.criteria.search import DISTINGUISHING_GAIN
from rthm_analysis.diagnosis.missing.motion import Along
from rthm_analysis.diagnosis.physical.formula_model import rounds_of
from rthm_analysis.diagnosis.physical.named_laws import kind_as
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.search.judging import merit
from rthm_analysis.diagnosis.search.replacing import beside_base, present, rounds_refitted
from rthm_analysis.diagnosis.search.starts import InitialGuess


def with_names(judged: Judgement) -> Judgement:
    """The model with kinds of the library in the place of a formula, judged; as it was unless all terms are
    kinds, none of them there already, and the names are earned as if they had been found as such.
    """
    physical, selection = judged.physical, judged.physical.selection
    if not (judged.earned and judged.at_noise and selection.formulas):
        return judged
    kinds = _kinds(physical)
    first = len(selection.rounds) - selection.formulas
    labels = [tried[0].label for tried in selection.rounds[:first]] + [one.label for one in kinds]
    if len(kinds) < selection.formulas or len(set(labels)) < len(labels):
        return judged
    model = beside_base(selection, [*present(selection)[:first], *kinds])
    try:
        fitted = physical.fitting.fit(model, most=FORMULA_FIT_STEPS)
    except np.linalg.LinAlgError:
        return judged
    if merit(fitted) > merit(selection.best) + DISTINGUISHING_GAIN:
        return judged
    rounds = [*selection.rounds[:first], *rounds_of(kinds, fitted)]
    with_kinds = rounds_refitted(physical.fitting, replace(selection, best=fitted, rounds=rounds))
    after = judged.of(replace(physical, selection=with_kinds))
    return after if after.at_noise and after.earned else judged


def _kinds(physical: Physical) -> list[InitialGuess]:
    """Kinds whose laws the terms of a formula are, of those that have one."""
    selection = physical.selection
    count = len(selection.rounds)
    terms = [
        i for i in range(count - selection.formulas, count) if selection.best.model.added[i].block == "plant"
    ]
    found = (kind_as(selection.best.model, i, _along(physical, i)) for i in terms)
    return [one for one in found if one is not None]


def _along(physical: Physical, index: int) -> Along:
    """Some samples of the motion where an effect acts."""
    at = physical.along(physical.selection.best.model.added[index].place)
    every = max(at.t.size // SAME_LAW_SAMPLES, 1)
    return Along(*(one[::every] for one in at))
