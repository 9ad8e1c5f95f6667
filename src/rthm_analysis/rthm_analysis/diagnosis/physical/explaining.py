"""From a retuned model to an explanation: plainer hypotheses first, then effects, maybe in short runs."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import FINE_FIT_GAIN, POOR_FIT_CHI2
from rthm_analysis.diagnosis.criteria.replay import SECOND_QUESTION_STEPS
from rthm_analysis.diagnosis.criteria.search import (
    DISTINGUISHING_GAIN,
    FINISHING_GAIN,
    FINISHING_STEPS,
    NEAR_NOISE_CHI2,
    VALUES_LEFT_SHARE,
)
from rthm_analysis.diagnosis.criteria.verdict import LOST_CHI2, NOISE_FLOOR_RATIO
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.physical.beginning import Baseline, in_short_runs
from rthm_analysis.diagnosis.physical.drafting import Draft, draft_of, drafted
from rthm_analysis.diagnosis.physical.formula_first import FormulaFirst
from rthm_analysis.diagnosis.physical.leaves_noise import at_noise
from rthm_analysis.diagnosis.physical.plainer import freed, needed_only, plain_fit
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.choosing import choose, is_lost
from rthm_analysis.diagnosis.search.judging import Selection, imitates, is_ahead, merit, reduced_chi2
from rthm_analysis.diagnosis.search.wire_from_force import wires_from_force


def chosen(
    begun: Baseline, seen: Evidence, settled: Model, train: int, *, formula: bool = True
) -> tuple[Baseline, Selection]:
    """Explain what the retuned model leaves by other values, or by effects, whichever predicts better.

    Other values of what the spec calls exact are tried before effects where the model is off, and after
    effects were found, which they may make needless. A `formula` is asked before combinations of effects.
    """
    fitting = begun.fitting
    plain = near = freed_near = draft = None
    hopeless = False
    if at_noise(fitting, begun.retuned):
        begun = begun._replace(retuned=_finished(fitting, begun.retuned))
    else:
        near = in_short_runs(begun, seen, settled, train) if fitting.reduced_chi2 > _lost(begun) else None
        if near is not None:
            begun = begun._replace(retuned=_begun_near(fitting, begun.retuned, near.retuned))
        freed_near = _freed_near(near)
        fitting.reduced_chi2 = reduced_chi2(fitting, begun.retuned)
        draft = draft_of(begun)
        hopeless = draft is not None and _values_are_not_it(begun, draft, freed_near)
        plain = None if hopeless else plain_fit(fitting, begun, freed_near)
        if plain is not None and reduced_chi2(fitting, plain) < NEAR_NOISE_CHI2:
            found = _beyond_plain(fitting, plain)
            if at_noise(fitting, found.best):
                return begun, found
    first, used = FormulaFirst(begun, near or begun) if formula else None, fitting.budget.used
    explained, selection = _by_effects(begun, near, draft, first)
    affords_another = fitting.budget.left > fitting.budget.used - used
    if first is not None and not at_noise(explained.fitting, selection.best):
        first.ask()
    if first is not None and first.found is not None and _is_needed(first.found, explained, selection):
        there, found = first.found
        return there, replace(found, limits=selection.limits)
    if explained.fitting is fitting and (selection.rounds or plain or hopeless):
        reached = at_noise(fitting, selection.best)
        if affords_another and not (hopeless and reached):
            plain = plain or plain_fit(fitting, begun, freed_near)
            selection = _plainer(fitting, selection, plain, reached=reached)
    if selection.imitates and reduced_chi2(explained.fitting, selection.best) > NOISE_FLOOR_RATIO**2:
        return _simple(begun, near, (explained, selection))
    return explained, selection


def _is_needed(formula: tuple[Baseline, Selection], explained: Baseline, kinds: Selection) -> bool:
    """Whether a formula says more than kinds do: these may be at the noise but for chance."""
    there, found = formula
    if there.fitting is not explained.fitting or not kinds.rounds:
        return True
    if reduced_chi2(explained.fitting, kinds.best) > NEAR_NOISE_CHI2:
        return True
    return merit(found.best) < merit(kinds.best) - DISTINGUISHING_GAIN


def _finished(fitting: Fitting, retuned: Fitted) -> Fitted:
    """Fit of the values that will be told to its end: on a ridge the last steps bring little and go far."""
    if retuned.settled <= FINISHING_GAIN or not retuned.model.parameters:
        return retuned
    return fitting.fit(retuned.model, most=FINISHING_STEPS, least=FINISHING_GAIN)


def _values_are_not_it(begun: Baseline, draft: Draft, near: Fitted | None) -> bool:
    """Whether a draft leaves no doubt that other values of mass, damping and stiffness are not enough."""
    fitting = draft.fitting
    try:
        nominal = fitting.fit(begun.nominal.model)
    except np.linalg.LinAlgError:
        return False
    there = begun._replace(fitting=fitting, nominal=nominal, retuned=draft.retuned)
    with fitting.based_on(fitting.base):  # the draft goes on with what it had
        return reduced_chi2(fitting, plain_fit(fitting, there, near)) > POOR_FIT_CHI2


def _simple(
    begun: Baseline, near: Baseline | None, found: tuple[Baseline, Selection]
) -> tuple[Baseline, Selection]:
    """Effects that can imitate no others, where those that can do not reach the noise: they say nothing then.

    What was found before stays where there are none, or where it leaves next to nothing of what they leave.
    """
    begun.fitting.progress("looking for plain kinds alone")
    begun.fitting.budget.allow(SECOND_QUESTION_STEPS)
    with ExitStack() as stack:
        for one in (begun, near):
            if one is not None:
                stack.enter_context(one.fitting.simple_only())
        explained, selection = _by_effects(begun, near)
    there, before = found
    left, of_plain = reduced_chi2(there.fitting, before.best), reduced_chi2(explained.fitting, selection.best)
    if not selection.rounds or is_ahead(left, of_plain):
        there.fitting.reduced_chi2 = left
        return found
    gone = tuple(tried[0].label for tried in before.rounds if imitates(*tried[0].label[:2]))
    return explained, replace(selection, imitating=gone)


def going_on(begun: Baseline, selection: Selection) -> tuple[Baseline, Selection] | None:
    """The same effects judged by a smaller noise, and what that shows beside them; None without any that are
    still at the noise.
    """
    whole = _over_the_whole(begun.fitting, selection.best.model) if selection.rounds else None
    if whole is None or reduced_chi2(begun.fitting, whole) > NOISE_FLOOR_RATIO**2:
        return None
    begun.fitting.reduced_chi2 = reduced_chi2(begun.fitting, whole)
    led = Selection(begun.retuned, whole, selection.rounds, selection.limits)
    return begun, replace(choose(begun.fitting, begun.retuned, begun=led), imitating=selection.imitating)


def fitted_again(begun: Baseline, selection: Selection) -> tuple[Baseline, Selection] | None:
    """The same effects with the values that a smaller noise gives them; None where there are none, or a fit
    diverges.
    """
    if not selection.rounds:
        return None
    try:
        base, best = (
            begun.fitting.fit(one.model, most=FINISHING_STEPS, least=FINE_FIT_GAIN)
            for one in (selection.base, selection.best)
        )
    except np.linalg.LinAlgError:
        return None
    return begun, replace(selection, base=base, best=best)


def is_behind(again: tuple[Baseline, Selection], before: Selection) -> bool:
    """Whether a second search, which may have had to end early, found less than the one before it."""
    begun, selection = again
    whole = _over_the_whole(begun.fitting, before.best.model) if begun.fitting.budget.spent else None
    return whole is not None and reduced_chi2(begun.fitting, whole) < reduced_chi2(
        begun.fitting, selection.best
    )


def _plainer(fitting: Fitting, selection: Selection, plain: Fitted, *, reached: bool) -> Selection:
    """The selection, or the plainer hypothesis, with effects beside it where it alone is not enough.

    `reached` says whether the selection leaves nothing but noise.
    """
    ahead = merit(selection.best) < merit(plain) - DISTINGUISHING_GAIN
    left, before = reduced_chi2(fitting, plain), reduced_chi2(fitting, selection.base)
    explains_little = left > max(POOR_FIT_CHI2, VALUES_LEFT_SHARE * before)
    if fitting.budget.spent or explains_little or (ahead and (reached or is_lost(fitting, selection))):
        fitting.reduced_chi2 = reduced_chi2(fitting, selection.best)
        return selection
    found = _beyond_plain(fitting, plain)
    says_less = (
        found.imitates and not selection.imitates and reduced_chi2(fitting, found.best) > NOISE_FLOOR_RATIO**2
    )
    if merit(found.best) < merit(selection.best) + DISTINGUISHING_GAIN and not says_less:
        return found
    fitting.reduced_chi2 = reduced_chi2(fitting, selection.best)
    return selection


def _beyond_plain(fitting: Fitting, plain: Fitted) -> Selection:
    """Effects beside other values of mass, damping, stiffness and wire, as few of both as it takes."""
    fitting.reduced_chi2 = reduced_chi2(fitting, plain)
    return needed_only(fitting, choose(fitting, plain))


def _lost(begun: Baseline) -> float:
    return LOST_CHI2 if begun.runs.length is None else np.inf


def _by_effects(
    begun: Baseline, short: Baseline | None, draft: Draft | None = None, first: FormulaFirst | None = None
) -> tuple[Baseline, Selection]:
    """Effects that explain what is left, and the runs in which they were found: short ones if need be.

    A formula that is enough by itself ends the search.
    """
    fitting, lost = begun.fitting, _lost(begun)
    fitting.reduced_chi2 = reduced_chi2(fitting, begun.retuned)

    def is_over(left: float) -> bool:
        return (first is not None and first.is_enough(left)) or left > lost

    if short is not None and draft is not None and wires_from_force(draft.fitting, draft.retuned):
        # Beside a wire that is no spring a wrong model is lost at once, whatever is tried.
        return _led_by(short, begun, Selection(begun.retuned, begun.retuned))
    selection = _choice(begun, is_over, draft)
    if first is not None and first.found is not None:
        return begun, selection
    if short is None or fitting.reduced_chi2 <= lost:
        return begun, selection
    return _led_by(short, begun, selection)


def _choice(begun: Baseline, stop: Callable[[float], bool], draft: Draft | None = None) -> Selection:
    """Effects that were found in a draft, and more where they are near the noise; else in the first place."""
    fitting = begun.fitting
    draft = draft or draft_of(begun)
    found = drafted(begun, draft, stop) if draft is not None else None
    if found is not None and (fitting.reduced_chi2 > NEAR_NOISE_CHI2 or not found.rounds):
        return found
    return choose(fitting, begun.retuned, stop, begun=found)


def _freed_near(short: Baseline | None) -> Fitted | None:
    """Fit of all entries in short runs."""
    if short is None:
        return None
    try:
        return short.fitting.fit(freed(short.fitting, short.nominal.model))
    except np.linalg.LinAlgError:
        return None


def _begun_near(fitting: Fitting, retuned: Fitted, near: Fitted) -> Fitted:
    """Retuned model of the whole recording, or what a fit reaches from that of short runs if it is better.

    Over many periods a wrong frequency is out of step, and a fit ends where it is in step by chance.
    """
    again = _over_the_whole(fitting, near.model)
    if again is None:
        return retuned
    best = min(retuned, again, key=lambda fitted: reduced_chi2(fitting, fitted))
    fitting.reduced_chi2 = reduced_chi2(fitting, best)
    return best


def _over_the_whole(fitting: Fitting, model: Model) -> Fitted | None:
    """Fit over the whole recording of what was found in short runs; None where it diverges."""
    try:
        return fitting.fit(model, most=FINISHING_STEPS, least=FINE_FIT_GAIN, affordable=True)
    except np.linalg.LinAlgError:
        return None


def _led_by(short: Baseline, begun: Baseline, selection: Selection) -> tuple[Baseline, Selection]:
    """Go on with a selection that was lost, led by what short runs show; in them, where only they can tell.

    Where they show nothing that is better over the whole, the selection stays as it is.
    """
    fitting, closer, near = begun.fitting, short.fitting, short.retuned
    closer.reduced_chi2 = reduced_chi2(closer, near)
    again = _choice(short, lambda left: left < POOR_FIT_CHI2)
    whole = _over_the_whole(fitting, again.best.model)
    if closer.reduced_chi2 >= POOR_FIT_CHI2:
        if whole is None or reduced_chi2(fitting, whole) > reduced_chi2(fitting, selection.best):
            return begun, selection
        fitting.reduced_chi2 = reduced_chi2(fitting, whole)
        return begun, Selection(begun.retuned, whole, again.rounds, selection.limits)
    if whole is not None and reduced_chi2(fitting, whole) < POOR_FIT_CHI2:
        fitting.reduced_chi2 = reduced_chi2(fitting, whole)
        led = Selection(begun.retuned, whole, again.rounds, selection.limits)
        return begun, choose(fitting, begun.retuned, begun=led)
    return short, choose(closer, near, begun=again)
