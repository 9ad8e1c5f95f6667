"""Add effects to a model, one at a time, as long as data that a fit has not seen are predicted better."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from rthm_analysis.diagnosis.fitting.fitting import WRONG, Fitted, Fitting
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.candidates import candidates
from rthm_analysis.diagnosis.search.refining import (
    CLEAR,
    CLOSE,
    PER_PARAMETER,
    RELEVANT,
    Tried,
    best_of_labels,
    fit_further,
    refined,
)
from rthm_analysis.diagnosis.search.screening import Screened, best_of_each, screen
from rthm_analysis.diagnosis.search.starts import Start
from rthm_analysis.diagnosis.search.told_wires import released, told_wire
from rthm_analysis.diagnosis.search.tones import harmonic_starts
from rthm_core.compiled import Floats
from rthm_core.errors import InputError

ENOUGH = 16.0
"""Gain of the cross-validated squared error, in units of the noise, that is no chance even for the best of
some hundred candidates."""

FLEXIBLE = {
    "bouc_wen",
    "clearance",
    "maxwell_branch",
    "fluid_memory",
    "hidden_mode",
    "harmonic_load",
    "end_stop",
}
"""Kinds with enough freedom to imitate others."""

UNFINISHED = 1.02
"""Doubt above which something may be left: the fit of an effect goes on before more is looked for."""

FINISHING = 24
"""Steps for which it goes on."""

PRUNING = 8
"""Steps of a fit without an effect that may be needless."""

REFINED, MOST_EFFECTS = 10, 3

PAIRED = 3
"""Plain kinds for which a companion is looked for where no single kind comes near the noise."""

NUMERICS = 1e-6
"""Part of a signal's standard deviation that nobody's arithmetic is trusted to resolve."""

PART = 0.05
"""Part of what is left of a mismatch that an effect must explain to be what is missing."""

NEAR = 0.15
"""Part of the best candidate's gain that another must promise to be refined."""


def never(doubt: float) -> bool:
    """Look for more as long as there is something to be found."""
    return False


@dataclass
class Choice:
    """What was chosen, and what it was chosen from.

    Attributes
    ----------
    base, best : Fitted
        Retuned model, and the one with all effects that were added.
    rounds : list of list of Tried
        Refined candidates of each round, best first; the first of a round was added if there is a next.
    limits : dict
        By block, kind and parameter: smallest amplitude that would have been seen.
    """

    base: Fitted
    best: Fitted
    rounds: list[list[Tried]] = field(default_factory=list)
    limits: dict[tuple[str, str, str], dict[str, float]] = field(default_factory=dict)


def choose(
    fitting: Fitting, base: Fitted, stop: Callable[[float], bool] = never, begun: Choice | None = None
) -> Choice:
    """Explain what is left of the residual by effects.

    Parameters
    ----------
    fitting : Fitting
    base : Fitted
        Retuned model.
    stop : callable
        Whether to leave it at what was found, given the doubt that is left.
    begun : Choice, optional
        What was found before, to go on with.
    """
    choice = begun or Choice(base, base)
    known = _known(fitting, choice.best)
    screened: list[Screened] = []
    while len(choice.rounds) < MOST_EFFECTS:
        said = "looking for physics that was left out" if not choice.rounds else "looking for more"
        fitting.progress(said)
        if not screened or fitting.doubt > CLOSE:
            screened = _screened(fitting, choice.best, known)
        else:
            screened = screen(fitting, choice.best, known, _others(screened, choice))
        if not choice.rounds:
            choice.limits = _limits(screened)
        promising = _promising(screened)
        if not promising:
            break
        fitting.progress(f"refining {', '.join(dict.fromkeys(s.start.added.kind for s in promising))}")
        tried = refined(fitting, choice.best, known, promising)
        told = _told(fitting, choice.best) if not choice.rounds and fitting.doubt > WRONG else []
        tried = best_of_labels([*told, *tried]) if told else tried
        if not tried or not better(tried[0], choice.best) or not _relevant(fitting, tried[0], choice):
            break
        lost, fitting.doubt = fitting.doubt > WRONG, doubt(fitting, tried[0].fitted)
        if lost:
            fitting.rebase(tried[0].fitted.model)
        if told and tried[0] is told[0]:
            tried[0] = _finished(fitting, _released(tried[0], choice.base))
        elif lost or fitting.doubt > UNFINISHED:
            tried[0] = _finished(fitting, tried[0], None if lost else known)
        if fitting.experiment.sharpen(tried[0].fitted.model.spec):
            tried[0] = _finished(fitting, tried[0])
        choice.rounds.append(tried)
        if len(choice.rounds) == 1 and fitting.doubt > WRONG:
            choice.rounds = _paired(fitting, choice.base, told or tried, tried) or choice.rounds
        choice.best = choice.rounds[-1][0].fitted
        known = _known(fitting, choice.best)
        if stop(fitting.doubt):
            return choice
    return _reconsidered(fitting, _without_the_needless(fitting, choice))


def _finished(fitting: Fitting, tried: Tried, known: Floats | None = None) -> Tried:
    """Fit an effect that was chosen to its end, from columns that are still known."""
    finished = fit_further(fitting, tried, known, FINISHING, least=1e-5)
    fitting.doubt = doubt(fitting, finished.fitted)
    return finished


def _paired(fitting: Fitting, base: Fitted, firsts: list[Tried], tried: list[Tried]) -> list[list[Tried]]:
    """Two rounds in which a plain kind and a companion come near the noise that no single kind came near.

    Of two effects that are both large, none explains much alone, and a flexible kind imitates both.
    """
    for first in [one for one in firsts if one.label[1] not in FLEXIBLE][:PAIRED]:
        fitting.progress(f"looking for what goes with {first.label[1]}")
        known = _known(fitting, first.fitted)
        promising = _promising(_screened(fitting, first.fitted, known))
        companions = refined(fitting, first.fitted, known, promising)
        if companions and doubt(fitting, companions[0].fitted) < WRONG:
            fitting.doubt = doubt(fitting, companions[0].fitted)
            fitting.rebase(companions[0].fitted.model)
            companions[0] = _finished(fitting, _released(companions[0], base))
            return [[first, *(one for one in tried if one is not first)], companions]
    return []


def _released(tried: Tried, base: Fitted) -> Tried:
    """The same, with the values of all effects left to the recording as a whole."""
    model = released(tried.fitted.model, len(base.model.parameters))
    return replace(tried, fitted=replace(tried.fitted, model=model, settled=np.inf))


def _told(fitting: Fitting, base: Fitted) -> list[Tried]:
    """The wire that its own force tells all about; none where it does not."""
    told = told_wire(fitting, base)
    if told is None:
        return []
    start, model = told
    begun = Tried(start, replace(base, model=model, settled=np.inf), np.inf)
    return [one for one in [fit_further(fitting, begun, None, 1)] if np.isfinite(one.error)]


def _without_the_needless(fitting: Fitting, choice: Choice) -> Choice:
    """Leave out effects that only helped the others, or what is uncertain, to find their values."""
    for index in reversed(range(len(choice.rounds))):
        if len(choice.rounds) == 1 and not choice.base.model.parameters:
            break  # nothing else could stand for it
        try:
            alone = fitting.fit(_model_without(choice, index), most=FINISHING if index == 0 else PRUNING)
        except np.linalg.LinAlgError:  # without the effect the model diverges
            continue
        last = choice.rounds[index][0]
        if better(Tried(last.start, choice.best, last.error), alone):
            continue
        rounds = [tried for i, tried in enumerate(choice.rounds) if i != index]
        fitting.doubt = doubt(fitting, alone)
        fewer = Choice(choice.base if rounds else alone, alone, rounds, choice.limits)
        return _without_the_needless(fitting, fewer)
    return choice


def _model_without(choice: Choice, index: int) -> Model:
    """The best model without one of its effects, all else with the values it has now."""
    best, base = choice.best.model, choice.base.model
    model = base.at(best.values[: len(base.parameters)])
    for i, tried in enumerate(choice.rounds):
        if i != index:
            start = tried[0].start
            added = replace(start.added, parameters=best.effect_values(i))
            model = model.plus(added, start.free, start.scales)
    return model


def _reconsidered(fitting: Fitting, choice: Choice) -> Choice:
    """Look for one companion of each effect that would make the others needless.

    A flexible kind that came first may have imitated what two plain ones do together.
    """
    others = [tried[0] for tried in choice.rounds]
    if len(others) < 2 or (others[0].label[1] not in FLEXIBLE and fitting.doubt < CLOSE):
        return choice
    if len(others) == 2:  # the second was the best companion of the first
        others = others[1:] if others[0].label[1] in FLEXIBLE else []
    best = choice
    for kept in reversed(others):
        fitting.progress("looking for a simpler explanation")
        model = kept.start.added_to(choice.base.model)
        try:
            alone = fitting.fit(model)
            known = _known(fitting, alone)
            tried = refined(fitting, alone, known, _promising(_screened(fitting, alone, known)))
        except (InputError, np.linalg.LinAlgError):
            continue
        if tried and _merit(tried[0].fitted) < _merit(best.best) - CLEAR:
            first = Tried(kept.start, alone, float(alone.left_out.sum()))
            best = Choice(choice.base, tried[0].fitted, [[first], tried], choice.limits)
            fitting.doubt = doubt(fitting, best.best)
    return best


def _merit(fitted: Fitted) -> float:
    """Squared error on data left out, with the price of the parameters; the smaller the better."""
    return float(fitted.left_out.sum()) + PER_PARAMETER * len(fitted.model.parameters)


def _others(screened: list[Screened], choice: Choice) -> list[Start]:
    """Best start of every kind and place that is not in the model yet."""
    present = {tried[0].label for tried in choice.rounds}
    firsts = best_of_each(screened, 1)
    return [
        s.start
        for s in firsts
        if (s.start.added.block, s.start.added.kind, s.start.added.place) not in present
    ]


def doubt(fitting: Fitting, fitted: Fitted) -> float:
    """Squared error per sample of a model, in units of the noise; at least 1."""
    return max(1.0, float(fitted.sums.squares.sum()) / max(fitting.expected, 1.0))


def _known(fitting: Fitting, fitted: Fitted) -> Floats:
    """Projected columns of a model's parameters; none where a small change of one makes it diverge."""
    try:
        columns = fitting.columns(fitted.model, fitted.residual, range(len(fitted.model.parameters)))
    except np.linalg.LinAlgError:
        return np.empty((0, fitted.residual.size))
    return fitting.projected(columns)


def _screened(fitting: Fitting, fitted: Fitted, known: Floats) -> list[Screened]:
    experiment, spec = fitting.experiment, fitted.model.spec
    motion = experiment.motion(spec, fitting.windows)
    starts = list(candidates(spec, experiment.evidence, motion, fitting.sigma))
    residual = np.where(fitting.weight > 0.0, fitted.residual.reshape(fitting.weight.shape), np.nan)
    starts += list(harmonic_starts(spec, experiment, residual, fitting.sigma))
    first = screen(fitting, fitted, known, starts)
    # A size far from the trial's was an extrapolation: look again from there.
    again = [s.start for s in best_of_each(first, 1)[:12] if s.gain > ENOUGH and s.start.amplitude]
    second = screen(fitting, fitted, known, again)
    both = sorted([*first, *second], key=lambda s: -s.gain)
    others = max((s.gain for s in both if s.start.added.block != "wire"), default=0.0)
    wires = [s for s in both if s.start.added.block == "wire" and s.gain > _worth_a_fit(others)]
    denied = fitting.cores.each(lambda s: _denied(fitting, fitted, s), wires)
    no = [id(s) for s, denied_by_force in zip(wires, denied, strict=True) if denied_by_force]
    return [s for s in both if id(s) not in no]


def _denied(fitting: Fitting, fitted: Fitted, one: Screened) -> bool:
    """Whether a wire that would explain the motion is denied by its own force."""
    with_it = one.start.added_to(fitted.model)
    try:
        return fitting.wires_alone.contradict(fitted.model, with_it)
    except InputError:
        return False


def _limits(screened: list[Screened]) -> dict[tuple[str, str, str], dict[str, float]]:
    """Smallest amplitudes that would have been seen, from the standard deviations of the amplitudes."""
    limits: dict[tuple[str, str, str], dict[str, float]] = {}
    for one in screened:
        added = one.start.added
        key = (added.block, added.kind, added.place)
        if one.start.amplitude and np.isfinite(one.std):
            name = one.start.amplitude[0]
            limits.setdefault(key, {name: float(np.sqrt(ENOUGH + one.start.luck) * one.std)})
    return limits


def _promising(screened: list[Screened]) -> list[Screened]:
    """Candidates worth a fit: those near the best in gain, the best kinds from two starts."""
    best = screened[0].gain if screened else 0.0
    if best < 0.7 * ENOUGH:
        return []
    near = [s for s in screened if s.gain > _worth_a_fit(best)]
    firsts = best_of_each(near, 1)[:REFINED]
    kinds = {_kind(s) for s in firsts[:5]}
    chosen = list(firsts)
    for one in (*best_of_each(near, 2), *best_of_each(near, 1, "n")):
        if _kind(one) in kinds and one not in chosen:
            chosen.append(one)
    return chosen


def _worth_a_fit(best: float) -> float:
    """Gain from which a candidate is fitted, given that of the best."""
    return max(0.6 * ENOUGH, NEAR * best)


def _kind(screened: Screened) -> tuple[str, str]:
    return screened.start.added.block, screened.start.added.kind


def better(new: Tried, old: Fitted) -> bool:
    """Whether an effect predicts unseen data better than chance and the scatter between parts would."""
    gains = old.left_out - new.fitted.left_out
    more = len(new.fitted.model.parameters) - len(old.model.parameters)
    scatter = float(np.sqrt(gains.size) * gains.std())
    enough = ENOUGH + new.start.luck + PER_PARAMETER * (more - 1)
    return float(gains.sum()) > max(enough, scatter)


def _relevant(fitting: Fitting, new: Tried, choice: Choice) -> bool:
    """Whether an effect matters; where no model reaches the noise, small terms only imitate what is left."""
    noise = fitting.expected
    before, after = float(choice.best.left_out.sum()), new.error
    gain = before - after
    start = float(choice.base.left_out.sum()) - noise
    if gain < max(_numerics(fitting), PART * (before - noise)):
        return False
    return after < CLOSE * noise or gain > RELEVANT * start or gain > 0.5 * (before - noise)


def _numerics(fitting: Fitting) -> float:
    """Squared error, in units of the noise, that a recording which was itself computed may have."""
    spread = NUMERICS * np.nanstd(fitting.experiment.evidence.measured, axis=0)
    return float(np.sum((fitting.weight * spread) ** 2))
