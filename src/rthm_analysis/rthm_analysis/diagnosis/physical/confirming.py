"""Unseen data confirm an effect or take it away: nothing else is put in its place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, cast

from rthm_analysis.diagnosis.criteria.noise import COLOURED_STD_RATIO
from rthm_analysis.diagnosis.criteria.verdict import (
    CONFIRMING_GAIN,
    CONTACT_EXPLAINED_SHARE,
    RIVAL_GAIN_SHARE,
    SLIGHT_SHARE,
    SLIGHT_STD_SHARE,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitted
from rthm_analysis.diagnosis.physical.above_noise import certain_only, needed_only, without_each
from rthm_analysis.diagnosis.physical.judged import held_out_squares, simulate_all
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.result import Refused
from rthm_analysis.diagnosis.search.judging import FittedCandidate, Selection, distinguishable, imitates
from rthm_analysis.diagnosis.search.replacing import is_sure

if TYPE_CHECKING:
    from rthm_core.effects.laws import PlantLaw

PATCHING = "beside a curved spring it did little but bend the curve of that spring"

IMITATES = "it can imitate others, and with it, too, more than the noise is left"

VALUES_NOT_TOLD = "beside the others the recording does not tell its values"

MAY_BE_ZERO = "beside what is left the recording does not tell it from zero"

SLIGHT = (
    "it matters little in the unseen data, and its values are not well known: the others may leave as much"
)

RIVALLED = "it does little in the unseen data, and another kind would do nearly as well"

NEEDLESS = "the others explain nearly as much without it"

NOT_CONFIRMED_UNSEEN = "it helped in the first two thirds of the recording, and unseen data do not confirm it"


def confirmed(physical: Physical) -> tuple[Physical, tuple[Refused, ...]]:
    """The same without the effects found last that do not help on unseen data, and why they went.

    Each must help beside those before it, and all together.
    """
    selection, refused = physical.selection, []
    least = CONFIRMING_GAIN if physical.noise.is_white else COLOURED_STD_RATIO**2 * CONFIRMING_GAIN
    if not selection.rounds:
        return physical, ()
    nothing, error = _left_by(physical, selection.base), _left_by(physical, selection.best)
    while selection.rounds:
        before = _without_last(selection)
        less = _left_by(physical, before.best) if before.rounds else nothing
        patches = less - error < CONTACT_EXPLAINED_SHARE * less and _patches(selection)
        if min(less, nothing) - error > least and not patches:
            break
        refused.append(_last_refused(selection, PATCHING if patches else NOT_CONFIRMED_UNSEEN))
        selection, error = before, less
    return replace(physical, selection=selection), tuple(refused)


def _left_by(physical: Physical, fitted: Fitted) -> float:
    """Squared error on unseen data, in units of the noise."""
    return held_out_squares(physical, simulate_all(physical, fitted).predicted)


def plain_only(physical: Physical) -> tuple[Physical, tuple[Refused, ...]]:
    """The same without the effects found last that can imitate others: above the noise they say nothing."""
    selection = physical.selection
    refused = [because(label, IMITATES) for label in selection.imitating]
    while selection.rounds and imitates(*selection.rounds[-1][0].label[:2]):
        refused.append(_last_refused(selection, IMITATES))
        selection = _without_last(selection)
    return replace(physical, selection=selection), tuple(refused)


def without_needless(physical: Physical) -> tuple[Physical, tuple[Refused, ...]]:
    """The same without effects that are hardly needed beside the others, and why they went."""
    physical, needless = needed_only(physical)
    return physical, tuple(because(label, NEEDLESS) for label in needless)


def without_vague(physical: Physical) -> tuple[Physical, tuple[Refused, ...]]:
    """The same without effects whose values are not told beside the others, and why they went."""
    physical, vague = certain_only(physical)
    return physical, tuple(because(label, VALUES_NOT_TOLD) for label in vague)


def without_unseen(physical: Physical, indices: Sequence[int]) -> tuple[Physical, tuple[Refused, ...]]:
    """The same without effects none of whose values is told from zero, and why they went."""
    return _without(physical, indices, MAY_BE_ZERO)


def without_slight(physical: Physical, shares: Sequence[float]) -> tuple[Physical, tuple[Refused, ...]]:
    """The same without effects that matter little and are not known well, and why they went.

    `shares` are the parts of the error on unseen data that the effects remove, in order.
    """
    best = physical.selection.best
    slight = [i for i, share in enumerate(shares) if share < SLIGHT_SHARE]
    return _without(physical, [i for i in slight if not is_sure(best, i, SLIGHT_STD_SHARE)], SLIGHT)


def rivalled(physical: Physical, shares: Sequence[float], negligible: float) -> list[int]:
    """Effects with less than a `negligible` share in whose place another would do nearly as well."""
    small = [i for i, share in enumerate(shares) if 0.0 <= share < negligible]
    return [i for i in small if _rivals(physical.selection, i)]


def without_rivalled(physical: Physical, indices: Sequence[int]) -> tuple[Physical, tuple[Refused, ...]]:
    """The same without effects that have rivals, and why they went."""
    return _without(physical, indices, RIVALLED)


def are_told_apart(physical: Physical, indices: Sequence[int]) -> bool:
    """Whether the recording tells effects from those that would do nearly as well."""
    selection = physical.selection
    rivals = [one for i in indices for one in _rivals(selection, i)]
    return all(distinguishable(selection.best, one.fitted) for one in rivals)


def _without(physical: Physical, indices: Sequence[int], why: str) -> tuple[Physical, tuple[Refused, ...]]:
    refused = tuple(because(physical.selection.rounds[i][0].label, why) for i in indices)
    return (without_each(physical, indices) if indices else physical), refused


def _rivals(selection: Selection, index: int) -> list[FittedCandidate]:
    """Other effects that would have done nearly as well as one that was added to others."""
    before = selection.rounds[index - 1][0].error if index else float(selection.base.left_out.sum())
    first, *others = selection.rounds[index]
    return [one for one in others if before - one.error > RIVAL_GAIN_SHARE * (before - first.error)]


def _last_refused(selection: Selection, why: str) -> Refused:
    return because(selection.rounds[-1][0].label, why)


def because(label: tuple[str, str, str], why: str) -> Refused:
    """An effect that is not told, and why."""
    block, kind, _ = label
    return Refused(block, kind, f"{kind.replace('_', ' ').capitalize()}: {why}.")


def _patches(selection: Selection) -> bool:
    """Whether the last effect is a contact beside a curved spring on the same dof: it may patch its curve."""
    *others, last = (tried[0] for tried in selection.rounds)
    springs = [one.label[2] for one in others if one.label[0] == "plant" and (one.law.power or 0) > 1]
    law = cast("type[PlantLaw]", last.law)
    return last.label[0] == "plant" and law.partition == "position" and last.label[2] in springs


def _without_last(selection: Selection) -> Selection:
    """Without the effect found last; terms of one formula stand or fall together."""
    rounds = selection.rounds[: -max(selection.formulas, 1)]
    return Selection(
        selection.base,
        rounds[-1][0].fitted if rounds else selection.base,
        rounds,
        selection.limits,
        selection.imitating,
    )
