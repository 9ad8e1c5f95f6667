"""From free curves of a missing force to a formula of it: terms that are fitted in free runs and judged."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    BEGINNINGS,
    COMPOSING_BUDGET,
    CURVE_GAIN,
    ENOUGH_GONE_SHARE,
    FORMULA_FITS,
    FORMULA_GAIN_SHARE,
    FORMULA_LEFT_RATIO,
    PLAIN_LEFT_RATIO,
    SAME_LEFT_RATIO,
    TERM_FEWEST_PERIODS,
    TERM_SHARE_ABOVE_NOISE,
)
from rthm_analysis.diagnosis.criteria.verdict import LOST_CHI2
from rthm_analysis.diagnosis.fitting.fitting import Fitted
from rthm_analysis.diagnosis.missing.curves import CurveFit, Regression
from rthm_analysis.diagnosis.missing.formulas import composed, fitted_together, has_plain, open_ended
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_analysis.diagnosis.physical.above_noise import without_each
from rthm_analysis.diagnosis.physical.acting import acting, acting_terms
from rthm_analysis.diagnosis.physical.formula_model import fit_terms, guess_of, rounds_of, with_all
from rthm_analysis.diagnosis.physical.formulated import written_of
from rthm_analysis.diagnosis.physical.named_laws import without_repeated
from rthm_analysis.diagnosis.physical.polygon import polygon
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.physical.term_by_term import beginning_as, term_by_term
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.judging import FittedCandidate, reduced_chi2
from rthm_analysis.diagnosis.search.replacing import is_identified
from rthm_analysis.diagnosis.search.starts import InitialGuess


def compose(judged: Judgement, curve: CurveFit) -> Judgement | None:
    """The model with a formula for what it leaves, or with the curve itself where no formula does as well,
    judged; None where neither does on unseen data what the free curve does.
    """
    missing, base = judged.told_missing, judged.told_fit
    judged.physical.fitting.progress("looking for a formula of the missing force")
    whole = max((one.excess for one in missing.curves), default=0.0)
    found: list[Judgement] = []
    share = judged.physical.fitting.budget.share(COMPOSING_BUDGET)
    for some in _ways(missing.regression, missing.curves):
        one = _large(judged, base, some, whole, curve.held_out_share)
        found += [one] if one is not None else []
        if (one is not None and one.at_noise) or share.is_over:
            break
    if not any(one.at_noise for one in found):
        found += _term_by_term(judged, base)
    for one in sorted(found, key=_price):
        if is_earned(judged, one, curve.held_out_share):
            return one
    bends = polygon(curve)
    last = with_formulas(judged, base, with_all(base.model, [bends]), [bends]) if bends is not None else None
    return last if last is not None and is_earned(judged, last, curve.held_out_share) else None


def _term_by_term(judged: Judgement, base: Fitted) -> Iterator[Judgement]:
    """Models with one term more each, judged, as far as their share of the work goes."""
    share = judged.physical.fitting.budget.share(COMPOSING_BUDGET)
    for followed in term_by_term(judged.physical, base):
        if (one := with_formulas(judged, base, *followed)) is not None:
            yield one
        if share.is_over:
            return


def _ways(regression: Regression, curves: list[CurveFit]) -> Iterator[tuple[Term, ...]]:
    """Terms that may be the missing force: plain ones, without an end, and any."""
    terms = composed(regression, curves)
    for some in (terms, composed(regression, curves, plain=False)) if has_plain(terms) else (terms,):
        yield some
        if (others := open_ended(regression, some)) != some:
            yield others


def compose_best(judged: Judgement, curve: CurveFit | None) -> Judgement | None:
    """The better one of the models with a formula for what acts from time to time, and for a free curve that
    is told.
    """
    within = compose_within(judged)
    if curve is None or (within is not None and within.gone > ENOUGH_GONE_SHARE):
        return within
    other = compose(judged, curve)
    if within is None or other is None:
        return within or other
    return within if _left_out(within) < PLAIN_LEFT_RATIO * _left_out(other) else other


def compose_within(judged: Judgement) -> Judgement | None:
    """The model with a formula for a force that acts in an interval alone, judged; None where there is none,
    or where it does not explain what unseen data show.
    """
    physical = judged.physical
    found = None if judged.earned else acting(physical, physical.train)
    if found is None:
        return None
    physical.fitting.progress("looking for a force that acts from time to time")
    regression, terms = acting_terms(physical, found, physical.train)
    after = _with(judged, physical.selection.base, regression, terms)
    return after if after is not None and is_earned(judged, after, 1.0) else None


def _left_out(judged: Judgement) -> float:
    """What a model leaves of the data that were left out of its fit, in units of the noise."""
    return float(judged.physical.selection.best.left_out.sum())


def _price(judged: Judgement) -> float:
    """What a model leaves, the dearer the more laws it has, and the more numbers within them: each has to be
    worth its place.
    """
    rounds = judged.physical.selection.rounds
    within = sum(len(tried[0].start.free) - 1 for tried in rounds)
    left = _left_out(judged) - judged.physical.fitting.expected
    return max(left, CURVE_GAIN) * PLAIN_LEFT_RATIO**within * SAME_LEFT_RATIO ** len(rounds)


def _large(
    judged: Judgement, base: Fitted, terms: tuple[Term, ...], whole: float, share: float
) -> Judgement | None:
    """The model with some terms, judged, with the large ones alone where it is earned and leaves more than
    the noise.
    """
    regression = judged.told_missing.regression
    found = _with(judged, base, regression, terms)
    if found is None or found.at_noise or not is_earned(judged, found, share):
        return found
    large = tuple(one for one in terms if one.gain > TERM_SHARE_ABOVE_NOISE * whole)
    return _with(judged, base, regression, large) if len(large) < len(terms) else found


def _with(
    judged: Judgement, base: Fitted, regression: Regression, terms: tuple[Term, ...]
) -> Judgement | None:
    """The model with some terms of a regression, judged; None where it diverges, or there are none."""
    if not (terms := without_repeated(regression, base.model, terms)):
        return None
    model, terms = fitted_together(regression, terms)
    guesses = [guess_of(one) for one in terms]
    return with_formulas(judged, base, with_all(model, guesses), guesses)


def with_formulas(
    judged: Judgement,
    base: Fitted,
    model: Model,
    guesses: list[InitialGuess],
    kinds: Sequence[list[FittedCandidate]] = (),
) -> Judgement | None:
    """A model with some formulas, of which `base` has none, judged; None where it diverges.

    Before the formulas it has the effects of `base` and some `kinds`. Effects whose values the recording does
    not tell beside the formulas are left out.
    """
    physical, selection = judged.physical, judged.physical.selection
    physical, fitted = _fitted(physical, base, model)
    if fitted is None:
        return None
    before = selection.rounds if judged.earned and not judged.composed else kinds
    rounds = [*before, *rounds_of(guesses, fitted)]
    with_formula = replace(physical, selection=replace(selection, best=fitted, rounds=rounds))
    kinds_alone = len(rounds) - with_formula.selection.formulas
    vague = [i for i in range(kinds_alone) if not is_identified(fitted, i)]
    with_formula = without_each(with_formula, vague) if vague else with_formula
    return judged.of(with_formula, composed=True)


def _fitted(physical: Physical, base: Fitted, model: Model) -> tuple[Physical, Fitted | None]:
    """The fit of a model with formulas, and where free runs begin for it; None where it diverges.

    A model in whose place another one is lost moves otherwise from the start: its own is estimated anew.
    """
    physical.fitting.reduced_chi2 = reduced_chi2(physical.fitting, base)
    if physical.fitting.reduced_chi2 < LOST_CHI2:
        return physical, fit_terms(physical.fitting, model)
    fitted, left = None, physical.fitting.reduced_chi2
    share = physical.fitting.budget.share(COMPOSING_BUDGET)
    for _ in range(BEGINNINGS):
        there = beginning_as(physical, model)
        there.fitting.reduced_chi2 = physical.fitting.reduced_chi2
        again = fit_terms(there.fitting, model, FORMULA_FITS)
        if again is None or (leaves := reduced_chi2(there.fitting, again)) >= left:
            break
        gains = leaves < FORMULA_LEFT_RATIO * left
        physical, fitted, model, left = there, again, again.model, leaves
        if not gains or share.is_over:
            break
    return physical, fitted


def _is_momentary(judged: Judgement) -> bool:
    """Whether a term acts for a part of a period alone: of which motion it is a law nobody can tell."""
    evidence, selection = judged.physical.evidence, judged.physical.selection
    count, end = len(selection.rounds), float(evidence.time[-1])
    terms = (written_of(selection.best, i) for i in range(count - selection.formulas, count))
    lasting = (one[1] - one[0] for term in terms if (one := term.interval(end)) is not None)
    return min(lasting, default=np.inf) < TERM_FEWEST_PERIODS * evidence.period


def is_earned(before: Judgement, after: Judgement, share: float) -> bool:
    """Whether a formula does as well on unseen data as a curve that explains a share of it, or reaches the
    noise.
    """
    if after.is_worse or _is_momentary(after):
        return False
    mismatch = before.squares["explained" if before.earned else "retuned"] - before.expected
    left = after.squares["explained"] - before.expected
    gone = 1.0 - max(left, 0.0) / max(mismatch, 1e-300)
    return after.at_noise or gone > FORMULA_GAIN_SHARE * min(share, 1.0)
