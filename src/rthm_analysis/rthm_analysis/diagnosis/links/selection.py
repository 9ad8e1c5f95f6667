"""Which kinds of physics the uses of a link need."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

from rthm_analysis.diagnosis.criteria.links import (
    LATENESS_GAIN,
    LINK_KIND_GAIN,
    LINK_TELLING_GAIN,
    STRAY_COST_PER_SAMPLE,
)
from rthm_analysis.diagnosis.links.fitting import Counted, counted, fitted, folds, gain
from rthm_analysis.diagnosis.links.models import Model

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.links.evidence import LinkEvidence
    from rthm_core.effects.declaration import Change

KINDS: tuple[Change, ...] = ("delay", "spread", "lost")
"""Parameters of the models that are physics: what a kind of effect changes of a link."""

PLAIN = ("lost", "delay", "spread")
"""Which kind is named where the recording does not tell them from each other."""


@dataclass(frozen=True)
class Selection:
    """Chosen kinds of one link, and how well others did.

    Attributes
    ----------
    kinds : tuple of str
        Of `KINDS`; none: nothing but lateness.
    model : Model
        Fitted with these kinds.
    nothing : Model
        Fitted with lateness alone.
    gains : dict
        Gain of each other selection over the chosen one, nats; negative.
    """

    kinds: tuple[Change, ...]
    model: Model
    nothing: Model
    gains: dict[tuple[Change, ...], float]


def is_exact(evidence: LinkEvidence) -> bool:
    """Whether nearly all samples come when the spec says, but for a few strays."""
    data = counted(evidence)
    return data.total(Model()) > -LINK_KIND_GAIN - STRAY_COST_PER_SAMPLE * data.samples


def choose(evidence: LinkEvidence, machine: bool = True) -> Selection:
    """Choose the fewest kinds that explain the uses of a link, judged on uses that they were not fitted to.

    Parameters
    ----------
    machine : bool
        Whether a busy machine may make samples late; False where it is known to be punctual.
    """
    data, exact = counted(evidence), Model()
    if is_exact(evidence):
        return Selection((), exact, exact, {})
    nothing = fitted(data, (), late=True) if machine else exact
    alone: list[tuple[Change, ...]] = [(kind,) for kind in KINDS]
    single = {kinds: fitted(data, kinds, late=False) for kinds in alone}
    best = _plainest(data, single)
    late = fitted(data, best, late=True)
    if data.total(late) > data.total(single[best]) + LATENESS_GAIN:
        single = {kinds: fitted(data, kinds, late=True) for kinds in alone}
        best = _plainest(data, single)
    halves = folds(evidence)
    enough = data.total(single[best]) > data.total(nothing) + LINK_KIND_GAIN
    if not enough or gain(halves, (single[best], best), (nothing, ())) < LINK_KIND_GAIN:
        return Selection((), nothing, nothing, {})
    return _with_more(data, halves, best, single, nothing)


def _plainest(data: Counted, models: dict[tuple[Change, ...], Model]) -> tuple[Change, ...]:
    """The most likely kind, or one that is as likely and needs no distribution of times."""
    best = max(data.total(model) for model in models.values())
    likely = [kinds for kinds, model in models.items() if data.total(model) > best - LINK_TELLING_GAIN]
    return min(likely, key=lambda kinds: PLAIN.index(kinds[0]))


def _with_more(
    data: Counted,
    halves: tuple[Counted, Counted],
    best: tuple[Change, ...],
    models: dict[tuple[Change, ...], Model],
    nothing: Model,
) -> Selection:
    """Add a second kind where it is needed."""
    late = models[best].share > 0.0
    pairs = [pair for pair in combinations(KINDS, 2) if set(best) < set(pair)]
    models = models | {pair: fitted(data, pair, late) for pair in pairs}
    pair = max(pairs, key=lambda pair: data.total(models[pair]))
    enough = data.total(models[pair]) > data.total(models[best]) + LINK_KIND_GAIN
    if enough and gain(halves, (models[pair], pair), (models[best], best)) > LINK_KIND_GAIN:
        best = pair
    gains = {kinds: data.total(model) - data.total(models[best]) for kinds, model in models.items()}
    return Selection(
        best, models[best], nothing, gains | {(): data.total(nothing) - data.total(models[best])}
    )
