"""Kinds that are looked for where a free curve shows them: a mass that changes, over the acceleration; it is
also tried where another mass throughout, or what imitates one, is told and leaves something.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import TypeVar

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    SHOWN_KIND_BUDGET,
    SHOWN_KIND_STARTS,
    SHOWN_KIND_STEPS,
    SHOWN_KIND_TRIALS,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.missing.curves import CurveFit
from rthm_analysis.diagnosis.physical.fewer import judged_of
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.replay.entries import entry_of
from rthm_analysis.diagnosis.search.judging import (
    FittedCandidate,
    best_of_labels,
    better,
    in_order,
    reduced_chi2,
)
from rthm_analysis.diagnosis.search.refining import finished_by_itself, fit_further, unfitted
from rthm_analysis.diagnosis.search.scene import dof_scene
from rthm_analysis.diagnosis.search.screening import ScoredCandidate, screen
from rthm_analysis.diagnosis.search.starts import InitialGuess, guessed
from rthm_core.effects.registry import ranked
from rthm_core.spec.effect import place_keys

C = TypeVar("C", ScoredCandidate, FittedCandidate)


def with_shown_kind(judged: Judgement, curve: CurveFit) -> Judgement | None:
    """The model with the best kind that is shown by a variable of a free curve, beside what was earned
    before, judged; None where there is no such kind, or it is not earned.
    """
    selection, base = judged.physical.selection, judged.told_fit
    starts = _starts(judged.physical, curve.site, curve.feature.depends_on, base)
    tried = _tried(judged.physical, base, starts)
    return _with(judged, selection.base, selection.rounds if judged.earned else [], tried) if tried else None


def with_changed_mass(judged: Judgement) -> Judgement | None:
    """The model with a mass that changes, judged, where it is nearer than what is told: another mass
    throughout, or a kind that imitates one. None where what is told leaves nothing but noise.
    """
    physical = judged.physical
    base, place = physical.nominal, _place_of_mass(judged)
    if place is None or not any(one.in_train for one in judged.left_over):
        return None
    tried = _tried(physical, base, _starts(physical, place, ("a",), base))
    return _with(judged, base, [], tried) if tried and better(tried[0], judged.told_fit) else None


def _place_of_mass(judged: Judgement) -> str | None:
    """Dof of which another mass was told, or an effect that imitates others, and nothing else; None where
    there is no such dof.
    """
    selection, plant = judged.physical.selection, judged.physical.spec.plant
    changed = [entry_of(one.key) for one in selection.base.model.parameters]
    if judged.earned:
        one, *others = (tried[0].label for tried in selection.rounds)
        alone = selection.imitates and not (others or changed)
        return one[2] if alone and one[0] == "plant" else None
    if len(changed) != 1 or changed[0] is None or plant is None:
        return None
    name, dof = changed[0]
    return plant.dofs[dof] if name == "plant.mass" else None


def _with(
    judged: Judgement, base: Fitted, before: list[list[FittedCandidate]], tried: list[FittedCandidate]
) -> Judgement | None:
    """The model with the first of some fitted kinds behind others, judged; None where it is not earned."""
    selection = replace(judged.physical.selection, base=base, best=tried[0].fitted, rounds=[*before, tried])
    after = judged_of(replace(judged.physical, selection=selection))
    return after if after.earned else None


def _starts(physical: Physical, place: str, variables: Collection[str], base: Fitted) -> list[InitialGuess]:
    """Where fits of the kinds begin that are shown by some variables, on a dof which has one of them at most;
    none between two dofs.
    """
    if place_keys(place)[1] is not None:
        return []
    spec, fitting = base.model.spec, physical.fitting
    there = {(one.law.shown_by, one.place) for one in spec.effects}
    motion = fitting.experiment.motion(spec, fitting.windows)
    scene = dof_scene(spec, fitting.experiment.evidence, motion, place)
    asked = [variable for variable in variables if (variable, place) not in there]
    laws = (law for variable in asked for law in ranked("plant", shown_by=variable))
    return [one for law in laws for one in guessed(law, "plant", place, scene, scene.seen)]


def _tried(physical: Physical, base: Fitted, starts: list[InitialGuess]) -> list[FittedCandidate]:
    """Fits of the training part, the best of each kind that is better than none, best first.

    What begins at once and what takes its time are fitted to the end: the one that is nearer at first need
    not be the law.
    """
    if not starts:
        return []
    fitting = physical.fitting
    fitting.progress(f"refining {', '.join(dict.fromkeys(one.added.kind for one in starts))}")
    fitting.budget.allow(SHOWN_KIND_BUDGET)
    fitting.reduced_chi2 = reduced_chi2(fitting, base)
    known = fitting.known(base)

    def begun(one: ScoredCandidate) -> FittedCandidate:
        candidate = unfitted(one.start, base, one.start.added_to(base.model))
        return fit_further(fitting, candidate, known, SHOWN_KIND_STEPS)

    ways = _ways(screen(fitting, base, known, starts))
    worth = [one for place in range(SHOWN_KIND_STARTS) for way in ways for one in way[place : place + 1]]
    tried = in_order(fitting.each_affordable(begun, worth))
    firsts = [way[0] for way in _ways(tried) if np.isfinite(way[0].error)]
    found = best_of_labels([finished_by_itself(fitting, _elsewhere(fitting, one)) for one in firsts])
    if found:
        fitting.reduced_chi2 = reduced_chi2(fitting, found[0].fitted)
    return found if found and better(found[0], base) else []


def _elsewhere(fitting: Fitting, one: FittedCandidate) -> FittedCandidate:
    """The candidate from where its instants explain most of some around them: no slope may lead there."""
    model, added = one.fitted.model, len(one.fitted.model.added) - 1
    places = model.places(added)
    for key in (key for key in places if one.law.unit(key, one.start.added.block) == "s"):
        apart = one.start.scales[key] * np.linspace(-1.0, 1.0, SHOWN_KIND_TRIALS)
        moves = [np.eye(model.values.size)[places[key]] * move for move in apart]
        tried = [model, *(model.at(model.values + move) for move in moves)]
        model = tried[int(np.argmin(fitting.squares_near(model, tried)))]
    if model is one.fitted.model:
        return one
    return fit_further(fitting, unfitted(one.start, one.fitted, model), None, SHOWN_KIND_STEPS)


def _ways(some: list[C]) -> list[list[C]]:
    """Candidates of each kind and of each set of parameters that are free, in order."""
    keys = dict.fromkeys((one.start.label, one.start.free) for one in some)
    return [[one for one in some if (one.start.label, one.start.free) == key] for key in keys]
