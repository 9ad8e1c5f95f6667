"""Other kinds in the place of an effect, fitted beside all others that were found.

An effect that was chosen before the others were known was compared with other kinds in a model that was
wrong for all of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.replay.model import Added, Model, Parameter
from rthm_analysis.diagnosis.search.judging import (
    CLEAR,
    Choice,
    Tried,
    better,
    distinguishable,
    doubt,
    merit,
)
from rthm_analysis.diagnosis.search.starts import Start
from rthm_core.errors import InputError
from rthm_core.quantity import Quantity

STEPS = 8
"""Steps of a fit with another kind in the place of one."""

RIVALS = 4
"""Kinds of each round that are looked at again."""


def model_of(choice: Choice, starts: list[tuple[int, Start]]) -> Model:
    """The best model with some of its effects only, all else with the values it has now.

    Where a start is of another kind than the effect that was chosen, it has its own values.
    """
    best, base = choice.best.model, choice.base.model
    model = base.at(best.values[: len(base.parameters)])
    for i, start in starts:
        same = start.added.kind == best.added[i].kind
        added = replace(start.added, parameters=best.effect_values(i)) if same else start.added
        model = model.plus(added, start.free, start.scales)
    return model


def rounds_refitted(fitting: Fitting, choice: Choice) -> Choice:
    """The same, what each round but the last added fitted again beside the values of the present base."""
    rounds = list(choice.rounds)
    for i, (first, *others) in enumerate(rounds[:-1]):
        upto = fitting.fit(model_of(choice, [(j, tried[0].start) for j, tried in enumerate(rounds[: i + 1])]))
        rounds[i] = [Tried(first.start, upto, float(upto.left_out.sum())), *others]
    return replace(choice, rounds=rounds)


def plainer(fitting: Fitting, choice: Choice) -> Choice:
    """Put plainer kinds in the place of others, where they predict unseen data as well."""
    for index, tried in enumerate(choice.rounds):
        for start in _plainer_starts(tried[0].start, choice.best, index):
            whole = _fitted_with(fitting, choice, index, start)
            if whole is not None and not better(Tried(tried[0].start, choice.best, tried[0].error), whole):
                choice = _replaced(fitting, choice, index, start, whole)
                break
    return choice


def is_identified(fitted: Fitted, index: int) -> bool:
    """Whether the data tell the main parameters of an added effect, within what is possible."""
    model, one = fitted.model, fitted.model.added[index]
    places = {key: i for key, i in model.places(index).items() if key not in one.law.secondary}
    variances = np.diag(fitted.sums.covariance())
    stds = {key: float(np.sqrt(max(variances[i], 0.0))) for key, i in places.items()}
    values = {key: model.parameters[i].value for key, i in places.items()}
    ends = any(_ends(one, key, model.parameters[i]) for key, i in places.items())
    return not ends and one.law.identified(values, stds)


def _ends(one: Added, key: str, parameter: Parameter) -> bool:
    """Whether a parameter is at an end of what is possible that is none of what a spec allows."""
    quantity = one.law.parameters[key]
    narrower = isinstance(quantity, Quantity) and parameter.nearest not in (quantity.lowest, quantity.highest)
    return parameter.at_bound and narrower


def _plainer_starts(start: Start, best: Fitted, index: int) -> Iterator[Start]:
    """Starts of the plainer kinds that an effect may stand for."""
    values = {k: v for k, v in best.model.effect_values(index).items() if not isinstance(v, str)}
    for one in start.added.law.plainer:
        parameters: dict[str, float | str] = dict(one.values(values))
        added = replace(start.added, kind=one.kind, parameters=parameters)
        scales = {name: abs(float(value)) for name, value in parameters.items()}
        signed = any(isinstance(q, Quantity) and q.lowest is None for q in added.law.parameters.values())
        yield Start(added, tuple(parameters), tuple(parameters), scales, signed)


def compared(fitting: Fitting, choice: Choice) -> Choice:
    """Fit other kinds that earlier rounds could not tell from the chosen one again, beside all the others.

    One that then predicts unseen data clearly better takes its place, or what is plainer and as good.
    """
    before = choice.best
    for index in range(len(choice.rounds) - 1):
        first, rivals = choice.rounds[index][0], _rivals(fitting, choice, index)
        again = [other if whole is None else whole for other, whole in rivals]
        rounds = [[first, *again] if i == index else one for i, one in enumerate(choice.rounds)]
        choice = Choice(choice.base, choice.best, rounds, choice.limits)
        beside = [whole for _, whole in rivals if whole is not None]
        winner = min(beside, key=lambda one: merit(one.fitted), default=None)
        if winner is not None and merit(winner.fitted) < merit(choice.best) - CLEAR:
            choice = _replaced(fitting, choice, index, winner.start, winner.fitted)
    return choice if choice.best is before else plainer(fitting, choice)


def _rivals(fitting: Fitting, choice: Choice, index: int) -> list[tuple[Tried, Tried | None]]:
    """Other kinds of a round: as they were, and beside all the others where it could not tell them apart."""
    first, *others = choice.rounds[index]
    rivals: list[tuple[Tried, Tried | None]] = []
    for other in others[:RIVALS]:
        if fitting.budget.spent or distinguishable(first.fitted, other.fitted):
            rivals.append((other, None))
            continue
        fitting.progress(f"comparing {first.label[1]} with {other.label[1]}")
        whole = _fitted_instead(fitting, choice, index, other)
        if whole is not None:
            rivals.append((other, Tried(other.start, whole, float(whole.left_out.sum()))))
    return rivals


def _fitted_instead(fitting: Fitting, choice: Choice, index: int, other: Tried) -> Fitted | None:
    """Fit with another kind in the place of an effect; None where that cannot be."""
    model = other.fitted.model
    own = next(i for i, one in reversed(list(enumerate(model.added))) if one.label == other.label[:2])
    values = model.effect_values(own)
    start = replace(other.start, added=replace(other.start.added, parameters=values))
    return _fitted_with(fitting, choice, index, start)


def _fitted_with(fitting: Fitting, choice: Choice, index: int, start: Start) -> Fitted | None:
    """Fit with a start in the place of an effect; None where that cannot be."""
    try:
        return fitting.fit(_with_another(choice, index, start), most=STEPS)
    except (InputError, np.linalg.LinAlgError):  # two of a kind at one place, or it diverges
        return None


def _with_another(choice: Choice, index: int, start: Start) -> Model:
    """The best model with another kind in the place of one of its effects."""
    starts = [(i, start if i == index else tried[0].start) for i, tried in enumerate(choice.rounds)]
    return model_of(choice, starts)


def _replaced(fitting: Fitting, choice: Choice, index: int, start: Start, whole: Fitted) -> Choice:
    """The choice with another kind in the place of an effect; `whole` is the fit of all effects with it."""
    upto = whole
    if index + 1 < len(choice.rounds):
        starts = [(i, tried[0].start) for i, tried in enumerate(choice.rounds[:index])]
        upto = fitting.fit(model_of(choice, [*starts, (index, start)]))
    first = Tried(start, upto, float(upto.left_out.sum()))
    others = [one for one in choice.rounds[index][1:] if one.label != start.label]
    rounds = [[first, *others] if i == index else one for i, one in enumerate(choice.rounds)]
    fitting.doubt = doubt(fitting, whole)
    return Choice(choice.base, whole, rounds, choice.limits)
