"""Numbers within a formula that may as well be zero, the sign of a wave, or a bound that is never reached: it
is told without them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import FORMULA_FIT_STEPS
from rthm_analysis.diagnosis.criteria.search import GAIN_OF_CHANCE
from rthm_analysis.diagnosis.physical.formula_model import rounds_of
from rthm_analysis.diagnosis.physical.formulated import written_of
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.physical.written import Written
from rthm_analysis.diagnosis.result import Value
from rthm_analysis.diagnosis.search.replacing import beside_base, present
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.effects.formula import NUMBERS, compared_with, without, without_compared
from rthm_core.effects.possible import UNSURE
from rthm_core.effects.written import Formula


def with_plainer_terms(judged: Judgement) -> Judgement:
    """The same without numbers that are only added to something and may be zero, as the place of a bell that
    stands at rest, and without bounds beyond what was recorded, as long as nothing but noise is left.
    """
    plainer: Judgement | None = judged
    while plainer is not None:
        judged, plainer = plainer, next(_plainer(plainer), None)
    return judged


def _plainer(judged: Judgement) -> Iterator[Judgement]:
    """Models with one number less, judged: those that are as good."""
    if not (judged.earned and judged.at_noise):
        return
    selection = judged.physical.selection
    starts = present(selection)
    for index in range(len(starts) - selection.formulas, len(starts)):
        for shorter in _shorter(judged, index, starts[index]):
            others = [*starts[:index], shorter, *starts[index + 1 :]]
            if (after := _with(judged, others)) is not None:
                yield after


def _shorter(judged: Judgement, index: int, start: InitialGuess) -> Iterator[InitialGuess]:
    """A term of the plant without one of its numbers that may be zero, or half a turn of a wave."""
    one = start.added
    if one.kind != Formula.kind:
        return
    written = written_of(judged.physical.selection.best, index, misfit=judged.misfit)
    for name in _never_met(judged, one.place, written):
        yield _without(start, name, without_compared(written.text, name))
    for name, value in written.values.items():
        turned = "sin(" in written.text and _may_be(value, np.pi)
        text = without(written.text, name) if turned or _may_be(value, 0.0) else None
        if text is None:
            continue
        # half a turn of a wave is its other sign
        yield _without(start, name, text, {NUMBERS[0]: -written.numbers[NUMBERS[0]]} if turned else {})


def _never_met(judged: Judgement, place: str, written: Written) -> Iterator[str]:
    """Numbers with which a variable is compared, and that lie beyond all that was recorded of it."""
    compared = compared_with(written.text)
    if not compared:
        return
    at = judged.physical.along(place)._asdict()
    for name, variable in compared.items():
        if not at[variable].min() < written.numbers[name] < at[variable].max():
            yield name


def _without(
    start: InitialGuess, name: str, text: str, others: Mapping[str, float] = MappingProxyType({})
) -> InitialGuess:
    """The same with another formula that lacks a number, and some other numbers."""
    one = start.added
    rest = {key: number for key, number in one.parameters.items() if key != name}
    return replace(
        start,
        added=replace(one, parameters={**rest, **others, Formula.text: text}),
        free=tuple(key for key in start.free if key != name),
        scales={key: scale for key, scale in start.scales.items() if key != name},
    )


def _may_be(value: Value, size: float) -> bool:
    """Whether a value leaves open whether it is of a size, of either sign: within two standard deviations."""
    return UNSURE * abs(abs(value.value) - size) <= value.std


def _with(judged: Judgement, starts: list[InitialGuess]) -> Judgement | None:
    """The model with these effects, judged; None where it is worse than by chance, or diverges."""
    physical, selection = judged.physical, judged.physical.selection
    first = len(starts) - selection.formulas
    try:
        fitted = physical.fitting.fit(beside_base(selection, starts), most=FORMULA_FIT_STEPS)
    except np.linalg.LinAlgError:
        return None
    is_worse = not float(fitted.left_out.sum()) - float(selection.best.left_out.sum()) < GAIN_OF_CHANCE
    if is_worse and not fitted.squares <= selection.best.squares:
        return None
    rounds = [*selection.rounds[:first], *rounds_of(starts[first:], fitted)]
    after = judged.of(
        replace(physical, selection=replace(selection, best=fitted, rounds=rounds)), composed=judged.composed
    )
    return after if after.earned and after.at_noise else None
