"""Judge fitted candidates: which is better, and whether one earns its place."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import takewhile
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.search import (
    AHEAD_LEFT_SHARE,
    ARITHMETIC_CHI2,
    DISTINGUISHING_GAIN,
    FINISHED_CHI2,
    GAIN_OF_CHANCE,
    GAIN_PER_PARAMETER,
    NEAR_NOISE_CHI2,
    RELEVANT_MAJOR_SHARE,
    RELEVANT_SHARE_OF_FIRST,
    RELEVANT_SHARE_OF_REST,
    TRUSTED_ARITHMETIC,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.effects import Effect, effect

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.search.screening import ScoredCandidate


@dataclass(frozen=True)
class FittedCandidate:
    """A candidate that was refined."""

    start: InitialGuess
    fitted: Fitted
    error: float

    @classmethod
    def of(cls, start: InitialGuess, fitted: Fitted) -> FittedCandidate:
        """A candidate with what its fit leaves of data left out."""
        return cls(start, fitted, float(fitted.left_out.sum()))

    @property
    def label(self) -> tuple[str, str, str]:
        """Block, kind and place."""
        return self.start.label

    @property
    def law(self) -> type[Effect]:
        """What its kind declares."""
        return self.start.added.law


@dataclass
class Selection:
    """What was chosen, and what it was chosen from.

    Attributes
    ----------
    base, best : Fitted
        Retuned model, and the one with all effects that were added.
    rounds : list of list of FittedCandidate
        Refined candidates of each round, best first; the first of a round was added if there is a next.
    limits : dict
        By block, kind and parameter: smallest amplitude that would have been seen.
    imitating : tuple
        Labels of effects that were left for plainer ones: they can imitate others and did not reach the
        noise.
    scores : list of ScoredCandidate
        What could have been added last.
    """

    base: Fitted
    best: Fitted
    rounds: list[list[FittedCandidate]] = field(default_factory=list)
    limits: dict[tuple[str, str, str], dict[str, float]] = field(default_factory=dict)
    imitating: tuple[tuple[str, str, str], ...] = ()
    scores: list[ScoredCandidate] = field(default_factory=list)

    @property
    def imitates(self) -> bool:
        """Whether any of its effects can imitate others."""
        return any(imitates(*tried[0].label[:2]) for tried in self.rounds)

    @property
    def in_pieces(self) -> bool:
        """Whether the same law of force acts twice at one place: a curve of another shape, put together."""
        labels = [tried[0].label for tried in self.rounds if not tried[0].law.repeats]
        return len(set(labels)) < len(labels)

    @property
    def in_terms(self) -> bool:
        """Whether several powers act at one place, as the first terms of a curve of another shape do."""
        places = [tried[0].label[2] for tried in self.rounds if tried[0].law.power is not None]
        return len(set(places)) < len(places)

    @property
    def formulas(self) -> int:
        """How many of its last effects are forces that a formula gives."""
        kinds = (tried[0].law.written for tried in reversed(self.rounds))
        return len(list(takewhile(bool, kinds)))

    @property
    def left_out(self) -> float:
        """What the best model leaves of data left out of its fit, over the noise; inf if it diverges."""
        left = float(self.best.left_out.sum())
        return left if np.isfinite(left) else np.inf

    @property
    def blames_several(self) -> bool:
        """Whether more than one sensor would have to be wrong at once: then what they measure is."""
        return len({tried[0].label[0] for tried in self.rounds if _is_sensor(tried[0].label[0])}) > 1

    @property
    def in_plant(self) -> bool:
        """Whether all of its effects are the plant's."""
        return all(tried[0].label[0] == "plant" for tried in self.rounds)

    @property
    def of_the_rig(self) -> bool:
        """Whether none of its effects is a sensor's."""
        return not any(_is_sensor(tried[0].label[0]) for tried in self.rounds)


def imitates(block: str, kind: str) -> bool:
    """Whether a kind has the freedom to stand for others, or excuses one sensor while others disagree."""
    return _is_sensor(block) or effect(kind, block).flexible


def _is_sensor(block: str) -> bool:
    return block.startswith("sensor.")


def looked_for(fitting: Fitting, starts: Iterable[InitialGuess]) -> Iterator[InitialGuess]:
    """Those starts that are looked for: all, or only what imitates no others; in a wire in which one kind was
    identified, only that.
    """
    for start in starts:
        block, kind, place = start.label
        identified = fitting.identified.get(place, kind) if block == "wire" else kind
        if kind == identified and not (fitting.simple and imitates(block, kind)):
            yield start


def reduced_chi2(fitting: Fitting, fitted: Fitted) -> float:
    """Squared error per sample of a model, in units of the noise; at least 1."""
    return max(1.0, float(fitted.sums.squares.sum()) / max(fitting.expected, 1.0))


def is_ahead(left: float, of_plain: float) -> bool:
    """Whether a kind that may imitate others says something: it leaves next to nothing of what plain kinds
    leave (both reduced chi-squared).
    """
    return left - 1.0 < AHEAD_LEFT_SHARE * of_plain


def noise_and_no_more(fitting: Fitting) -> float:
    """Reduced chi-squared below which a model leaves noise and no more.

    A draft leaves a little more, and is asked again with all samples.
    """
    return NEAR_NOISE_CHI2 if fitting.experiment.is_draft else FINISHED_CHI2


def clear_gain(old: Fitted, new: Fitted, enough: float) -> bool:
    """Whether unseen data are predicted better than chance and the scatter between parts would have it."""
    gains = old.left_out - new.left_out
    return float(gains.sum()) > max(enough, float(np.sqrt(gains.size) * gains.std()))


def better(new: FittedCandidate, old: Fitted) -> bool:
    """Whether an effect predicts unseen data clearly better, the more so the more parameters it has."""
    more = len(new.fitted.model.parameters) - len(old.model.parameters)
    return clear_gain(
        old, new.fitted, GAIN_OF_CHANCE + new.start.look_elsewhere + GAIN_PER_PARAMETER * (more - 1)
    )


def relevant(fitting: Fitting, new: FittedCandidate, selection: Selection) -> bool:
    """Whether an effect matters; where no model reaches the noise, small terms only imitate what is left."""
    noise = fitting.expected
    before, after = float(selection.best.left_out.sum()), new.error
    gain = before - after
    if before < ARITHMETIC_CHI2 * noise:
        return False
    start = float(selection.base.left_out.sum()) - noise
    if gain < max(_numerics(fitting), RELEVANT_SHARE_OF_REST * (before - noise)):
        return False
    return (
        after < NEAR_NOISE_CHI2 * noise
        or gain > RELEVANT_SHARE_OF_FIRST * start
        or gain > RELEVANT_MAJOR_SHARE * (before - noise)
    )


def _numerics(fitting: Fitting) -> float:
    """Squared error, in units of the noise, that a recording which was itself computed may have."""
    spread = TRUSTED_ARITHMETIC * np.nanstd(fitting.experiment.evidence.measured, axis=0)
    return float(np.sum((fitting.weight * spread) ** 2))


def price(effects: int, parameters: int) -> float:
    """What effects with so many parameters of their own have to bring together, in units of the noise."""
    return GAIN_OF_CHANCE * effects + GAIN_PER_PARAMETER * (parameters - effects)


def merit(fitted: Fitted) -> float:
    """Squared error on data left out, with the price of the parameters, and of values that are far from what
    the spec states; the smaller the better.
    """
    model = fitted.model
    return float(fitted.left_out.sum()) + GAIN_PER_PARAMETER * len(model.parameters) + model.unlikeliness


def best_of_labels(tried: list[FittedCandidate]) -> list[FittedCandidate]:
    """Best of each kind and place, in order."""
    best: dict[tuple[str, str, str], FittedCandidate] = {}
    for one in in_order(tried):
        best.setdefault(one.label, one)
    return list(best.values())


def in_order(tried: list[FittedCandidate]) -> list[FittedCandidate]:
    """Smallest error first, where every parameter has to earn its place."""
    return sorted(tried, key=lambda one: merit(one.fitted))


def distinguishable(best: Fitted, other: Fitted) -> bool:
    """Whether the recording tells two fits apart."""
    return clear_gain(other, best, DISTINGUISHING_GAIN)
