"""Which of the effects that a search selected are earned together."""

from __future__ import annotations

from functools import partial

from rthm_analysis.diagnosis.criteria.verdict import NEGLIGIBLE_SHARE
from rthm_analysis.diagnosis.physical.confirming import (
    are_told_apart,
    plain_only,
    rivalled,
    without_needless,
    without_rivalled,
    without_slight,
    without_unseen,
    without_vague,
)
from rthm_analysis.diagnosis.physical.judged import simulate_all
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.result import Refused


def with_fewer(physical: Physical, judged: Judgement) -> tuple[Physical, Judgement, tuple[Refused, ...]]:
    """The same, or with fewer effects that are earned where all together are not; why the others went."""
    refused: tuple[Refused, ...] = ()
    if judged.names and not physical.selection.formulas:
        physical, judged, refused = _without_doubtful(physical, judged)
    while judged.names and not physical.selection.formulas and judged.unseen:
        count = len(physical.selection.rounds)
        physical, unseen = without_unseen(physical, judged.unseen)
        if len(physical.selection.rounds) == count:
            break
        refused = (*refused, *unseen)
        judged = judged_of(physical)
    if judged.names and not judged.at_noise and not physical.selection.imitates:
        physical, needless = without_needless(physical)
        refused = (*refused, *needless)
        judged = judged_of(physical) if needless else judged
    if judged.names and not judged.earned:
        certain, vague = without_vague(physical)
        again = judged_of(certain) if vague else judged
        if again.earned:
            return certain, again, (*refused, *vague)
        physical, imitating = plain_only(physical)
        refused = (*refused, *imitating)
        judged = judged_of(physical) if imitating else judged
    return physical, judged, refused


def _without_doubtful(
    physical: Physical, judged: Judgement
) -> tuple[Physical, Judgement, tuple[Refused, ...]]:
    """The same without small effects that are not well known, or whose kind is not sure, and why they went.

    One whose kind is not sure stays where the others do not reach the noise without it, and the recording
    tells it from its rivals.
    """
    physical, refused = without_slight(physical, judged.shares)
    judged = judged_of(physical) if refused else judged
    if not (judged.earned and judged.at_noise and len(physical.selection.rounds) > 1):
        return physical, judged, refused
    unsure = rivalled(physical, judged.shares, negligible(judged))
    fewer, why = without_rivalled(physical, unsure)
    again = judged_of(fewer) if why else judged
    if again.at_noise or not are_told_apart(physical, unsure):
        return fewer, again, (*refused, *why)
    return physical, judged, refused


def judged_of(physical: Physical) -> Judgement:
    """The models simulated over the whole recording, ready to be judged."""
    selection = physical.selection
    fitted = {"nominal": physical.nominal, "retuned": selection.base, "explained": selection.best}
    simulated = physical.fitting.cores.each_in_parts(partial(simulate_all, physical), fitted.values())
    return Judgement(physical, dict(zip(fitted, simulated, strict=True)))


def negligible(judged: Judgement) -> float:
    """Share of the squared error on unseen data below which an effect does not matter."""
    return NEGLIGIBLE_SHARE * max(judged.gone * judged.mismatch, 1e-300)
