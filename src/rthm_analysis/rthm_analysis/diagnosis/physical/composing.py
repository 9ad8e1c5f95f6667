"""From free curves of a missing force to a formula of it: terms that are fitted in free runs and judged."""

from __future__ import annotations

from dataclasses import replace

from rthm_analysis.diagnosis.criteria.missing import FORMULA_GAIN_SHARE, TERM_SHARE_ABOVE_NOISE
from rthm_analysis.diagnosis.fitting.fitting import Fitted
from rthm_analysis.diagnosis.missing.curves import CurveFit
from rthm_analysis.diagnosis.missing.formulas import composed, open_ended
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_analysis.diagnosis.physical.above_noise import without_each
from rthm_analysis.diagnosis.physical.formula_model import fit_terms, guess_of, rounds_of, with_all
from rthm_analysis.diagnosis.physical.judged import simulate_all
from rthm_analysis.diagnosis.physical.polygon import polygon
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.search.judging import reduced_chi2
from rthm_analysis.diagnosis.search.replacing import is_identified
from rthm_analysis.diagnosis.search.starts import InitialGuess


def compose(judged: Judgement, curve: CurveFit) -> Judgement | None:
    """The model with a formula for what it leaves, or with the curve itself where no formula does as well,
    judged; None where neither does on unseen data what the free curve does.
    """
    missing, base = judged.told_missing, judged.told_fit
    judged.physical.fitting.progress("looking for a formula of the missing force")
    terms = composed(missing.regression, missing.curves)
    whole = max((one.excess for one in missing.curves), default=0.0)
    ways = dict.fromkeys([terms, open_ended(missing.regression, terms)])
    found = [one for one in (_large(judged, base, some, whole) for some in ways) if one is not None]
    for one in sorted(found, key=_left_out):
        if is_earned(judged, one, curve.held_out_share):
            return one
    bends = polygon(curve)
    last = with_formulas(judged, base, [bends]) if bends is not None else None
    return last if last is not None and is_earned(judged, last, curve.held_out_share) else None


def _left_out(judged: Judgement) -> float:
    """What a model leaves of the data that were left out of its fit, in units of the noise."""
    return float(judged.physical.selection.best.left_out.sum())


def _large(judged: Judgement, base: Fitted, terms: tuple[Term, ...], whole: float) -> Judgement | None:
    """The model with some terms, judged, with the large ones alone where it leaves more than the noise."""
    found = _with(judged, base, terms)
    if found is None or found.at_noise:
        return found
    large = tuple(one for one in terms if one.gain > TERM_SHARE_ABOVE_NOISE * whole)
    return _with(judged, base, large) if len(large) < len(terms) else found


def _with(judged: Judgement, base: Fitted, terms: tuple[Term, ...]) -> Judgement | None:
    """The model with some terms, judged; None where it diverges, or there are none."""
    return with_formulas(judged, base, [guess_of(one) for one in terms]) if terms else None


def with_formulas(judged: Judgement, base: Fitted, guesses: list[InitialGuess]) -> Judgement | None:
    """The model with some formulas, judged; None where it diverges.

    Effects whose values the recording does not tell beside the formulas are left out.
    """
    physical, selection = judged.physical, judged.physical.selection
    physical.fitting.reduced_chi2 = reduced_chi2(physical.fitting, base)
    fitted = fit_terms(physical.fitting, with_all(base.model, guesses))
    if fitted is None:
        return None
    rounds = [*(selection.rounds if judged.earned else ()), *rounds_of(guesses, fitted)]
    with_formula = replace(physical, selection=replace(selection, best=fitted, rounds=rounds))
    vague = [i for i in range(len(rounds) - len(guesses)) if not is_identified(fitted, i)]
    with_formula = without_each(with_formula, vague) if vague else with_formula
    runs = judged.runs | {"explained": simulate_all(with_formula, with_formula.selection.best)}
    return Judgement(with_formula, runs, composed=True)


def is_earned(before: Judgement, after: Judgement, share: float) -> bool:
    """Whether a formula does as well on unseen data as a curve that explains a share of it, or reaches the
    noise.
    """
    if after.is_worse:
        return False
    mismatch = before.squares["explained" if before.earned else "retuned"] - before.expected
    left = after.squares["explained"] - before.expected
    gone = 1.0 - max(left, 0.0) / max(mismatch, 1e-300)
    return after.at_noise or gone > FORMULA_GAIN_SHARE * min(share, 1.0)
