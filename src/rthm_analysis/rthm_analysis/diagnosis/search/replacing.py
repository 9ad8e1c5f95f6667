"""Other kinds in the place of an effect, fitted beside all others that were found.

An effect that was chosen before the others were known was compared with other kinds in a model that was
wrong for all of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.criteria.search import (
    DISTINGUISHING_GAIN,
    RIVALS_OF_A_ROUND,
    STEPS_WITH_ANOTHER_KIND,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model, Parameter
from rthm_analysis.diagnosis.search.judging import (
    FittedCandidate,
    Selection,
    better,
    distinguishable,
    in_order,
    merit,
    reduced_chi2,
)
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.effects.possible import Plainer, Twin, identified
from rthm_core.errors import InputError
from rthm_core.quantity import Quantity


def present(selection: Selection) -> list[InitialGuess]:
    """The effects of a selection, with the values they have now."""
    best = selection.best.model
    return [tried[0].start.having(best.effect_values(i)) for i, tried in enumerate(selection.rounds)]


def beside_base(selection: Selection, starts: Iterable[InitialGuess]) -> Model:
    """Some effects beside what is uncertain, which has the values it has now."""
    base = selection.base.model
    model = base.at(selection.best.model.values[: len(base.parameters)])
    for start in starts:
        model = start.added_to(model)
    return model


def model_of(selection: Selection, starts: list[tuple[int, InitialGuess]]) -> Model:
    """The best model with some of its effects only, all else with the values it has now.

    Where a start is of another kind than the effect that was chosen, it has its own values.
    """
    best = selection.best.model
    kept = (
        start.having(best.effect_values(i)) if start.added.kind == best.added[i].kind else start
        for i, start in starts
    )
    return beside_base(selection, kept)


def rounds_refitted(fitting: Fitting, selection: Selection) -> Selection:
    """The same, what each round but the last added fitted again beside the values of the present base.

    A round that cannot be fitted without those after it keeps the fit it had.
    """
    rounds = list(selection.rounds)
    for i, (first, *others) in enumerate(rounds[:-1]):
        present = model_of(selection, [(j, tried[0].start) for j, tried in enumerate(rounds[: i + 1])])
        try:
            upto = fitting.fit(present)
        except np.linalg.LinAlgError:
            continue
        rounds[i] = [FittedCandidate.of(first.start, upto), *others]
    return replace(selection, rounds=rounds)


def plainer(fitting: Fitting, selection: Selection) -> Selection:
    """Put plainer kinds in the place of others, where they predict unseen data as well."""
    for index, tried in enumerate(selection.rounds):
        for start in _starts_as(tried[0].start, selection.best, index, tried[0].law.plainer):
            whole = _fitted_with(fitting, selection, index, start)
            if whole is not None and not better(
                FittedCandidate(tried[0].start, selection.best, tried[0].error), whole
            ):
                selection = _replaced(fitting, selection, index, start, whole)
                break
    return selection


def or_twin(fitting: Fitting, selection: Selection) -> Selection:
    """The same, or a kind of nearly the same force as the last effect, where it predicts unseen data better.

    Two such kinds differ by less than what is left of either while its values are still far off.
    """
    *earlier, (first, *others) = selection.rounds
    twins = in_order([*_twins(fitting, selection)])
    if not twins:
        return selection
    fitted_again = [one.label for one in twins]
    others = [one for one in others if one.label not in fitted_again]
    ahead = merit(twins[0].fitted) < merit(first.fitted) - DISTINGUISHING_GAIN
    best, *rest = [*twins, first, *others] if ahead else [first, *twins, *others]
    fitting.reduced_chi2 = reduced_chi2(fitting, best.fitted)
    return replace(selection, best=best.fitted, rounds=[*earlier, [best, *rest]])


def _twins(fitting: Fitting, selection: Selection) -> Iterator[FittedCandidate]:
    """Fits of such kinds in the place of the last effect, from the values that it has."""
    index = len(selection.rounds) - 1
    first = selection.rounds[index][0]
    for start in _starts_as(first.start, first.fitted, index, first.law.twins):
        fitting.progress(f"comparing {first.label[1]} with {start.label[1]}")
        whole = _fitted_with(fitting, selection, index, start)
        if whole is not None:
            yield FittedCandidate.of(start, whole)


def is_identified(fitted: Fitted, index: int) -> bool:
    """Whether the data tell the main parameters of an added effect, within what is possible."""
    model, one = fitted.model, fitted.model.added[index]
    values, stds = _main(fitted, index)
    ends = any(
        _ends(one, key, model.parameters[i]) for key, i in model.places(index).items() if key in values
    )
    return not ends and one.law.identified(values, stds)


def is_sure(fitted: Fitted, index: int, share: float) -> bool:
    """Whether the standard deviations of all main parameters of an effect are at most this share of them."""
    values, stds = _main(fitted, index)
    return all(std <= share * abs(values[key]) for key, std in stds.items())


def is_seen(fitted: Fitted, index: int, misfit: float = 1.0) -> bool:
    """Whether the data tell any of the main parameters of an added effect, where its standard deviations are
    so many times what noise alone leaves.
    """
    values, stds = _main(fitted, index)
    return not values or any(identified({key: values[key]}, {key: misfit * stds[key]}) for key in values)


def _main(fitted: Fitted, index: int) -> tuple[dict[str, float], dict[str, float]]:
    """Main parameters of an added effect that were fitted, and their standard deviations."""
    model, one = fitted.model, fitted.model.added[index]
    places = {key: i for key, i in model.places(index).items() if key not in one.law.secondary}
    variances = np.diag(fitted.sums.covariance())
    stds = {key: float(np.sqrt(max(variances[i], 0.0))) for key, i in places.items()}
    return {key: model.parameters[i].value for key, i in places.items()}, stds


def _ends(one: EffectInstance, key: str, parameter: Parameter) -> bool:
    """Whether a parameter is at an end of what is possible that is none of what a spec allows."""
    quantity = one.law.parameters[key]
    narrower = isinstance(quantity, Quantity) and parameter.nearest not in (quantity.lowest, quantity.highest)
    return parameter.at_bound and narrower


def _starts_as(
    start: InitialGuess, best: Fitted, index: int, kinds: Iterable[Plainer | Twin]
) -> Iterator[InitialGuess]:
    """Starts of other kinds from the values that an effect has now."""
    values = {k: v for k, v in best.model.effect_values(index).items() if not isinstance(v, str)}
    for one in kinds:
        parameters: dict[str, float | str] = dict(one.values(values))
        added = replace(start.added, kind=one.kind, parameters=parameters)
        scales = {name: abs(float(value)) for name, value in parameters.items()}
        signed = any(isinstance(q, Quantity) and q.lowest is None for q in added.law.parameters.values())
        yield InitialGuess(added, tuple(parameters), tuple(parameters), scales, signed)


def compared(fitting: Fitting, selection: Selection) -> Selection:
    """Fit other kinds that earlier rounds could not tell from the chosen one again, beside all the others.

    One that then predicts unseen data clearly better takes its place, or what is plainer and as good.
    """
    before = selection.best
    for index in range(len(selection.rounds) - 1):
        first, rivals = selection.rounds[index][0], _rivals(fitting, selection, index)
        again = [other if whole is None else whole for other, whole in rivals]
        rounds = [[first, *again] if i == index else one for i, one in enumerate(selection.rounds)]
        selection = Selection(selection.base, selection.best, rounds, selection.limits)
        beside = [whole for _, whole in rivals if whole is not None]
        winner = min(beside, key=lambda one: merit(one.fitted), default=None)
        if winner is not None and merit(winner.fitted) < merit(selection.best) - DISTINGUISHING_GAIN:
            selection = _replaced(fitting, selection, index, winner.start, winner.fitted)
    return selection if selection.best is before else plainer(fitting, selection)


def _rivals(
    fitting: Fitting, selection: Selection, index: int
) -> list[tuple[FittedCandidate, FittedCandidate | None]]:
    """Other kinds of a round: as they were, and beside all the others where it could not tell them apart."""
    first, *others = selection.rounds[index]
    rivals: list[tuple[FittedCandidate, FittedCandidate | None]] = []
    for other in others[:RIVALS_OF_A_ROUND]:
        if fitting.budget.spent or distinguishable(first.fitted, other.fitted):
            rivals.append((other, None))
            continue
        fitting.progress(f"comparing {first.label[1]} with {other.label[1]}")
        whole = _fitted_instead(fitting, selection, index, other)
        if whole is not None:
            rivals.append((other, FittedCandidate.of(other.start, whole)))
    return rivals


def _fitted_instead(
    fitting: Fitting, selection: Selection, index: int, other: FittedCandidate
) -> Fitted | None:
    """Fit with another kind in the place of an effect; None where that cannot be."""
    model = other.fitted.model
    own = next(i for i, one in reversed(list(enumerate(model.added))) if one.label == other.label[:2])
    values = model.effect_values(own)
    start = other.start.having(values)
    return _fitted_with(fitting, selection, index, start)


def _fitted_with(fitting: Fitting, selection: Selection, index: int, start: InitialGuess) -> Fitted | None:
    """Fit with a start in the place of an effect; None where that cannot be."""
    try:
        return fitting.fit(_with_another(selection, index, start), most=STEPS_WITH_ANOTHER_KIND)
    except (InputError, np.linalg.LinAlgError):  # two of a kind at one place, or it diverges
        return None


def _with_another(selection: Selection, index: int, start: InitialGuess) -> Model:
    """The best model with another kind in the place of one of its effects."""
    starts = [(i, start if i == index else tried[0].start) for i, tried in enumerate(selection.rounds)]
    return model_of(selection, starts)


def _replaced(
    fitting: Fitting, selection: Selection, index: int, start: InitialGuess, whole: Fitted
) -> Selection:
    """The same with another kind in the place of an effect; `whole` is the fit of all effects with it."""
    upto = whole
    if index + 1 < len(selection.rounds):
        starts = [(i, tried[0].start) for i, tried in enumerate(selection.rounds[:index])]
        upto = fitting.fit(model_of(selection, [*starts, (index, start)]))
    first = FittedCandidate.of(start, upto)
    others = [one for one in selection.rounds[index][1:] if one.label != start.label]
    rounds = [[first, *others] if i == index else one for i, one in enumerate(selection.rounds)]
    fitting.reduced_chi2 = reduced_chi2(fitting, whole)
    return Selection(selection.base, whole, rounds, selection.limits)
