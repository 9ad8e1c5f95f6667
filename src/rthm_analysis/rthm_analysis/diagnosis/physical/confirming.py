"""Unseen data confirm an effect or take it away: nothing else is put in its place."""

from __future__ import annotations

from dataclasses import replace

from rthm_analysis.diagnosis.physical.judged import held_out_squares, simulate_all
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.result import Refused
from rthm_analysis.diagnosis.search.judging import Choice

CONFIRMED = 4.0
"""Squared error on unseen data, in units of the noise, that an effect must remove: two standard deviations of
chance for one parameter.
"""

UNCONFIRMED = "it helped in the first two thirds of the recording, and unseen data do not confirm it"


def confirmed(physical: Physical) -> tuple[Physical, tuple[Refused, ...]]:
    """The same without the effects found last that do not help on unseen data, and why they went."""
    choice, refused = physical.choice, []
    while choice.rounds:
        before = _without_last(choice)
        error = held_out_squares(physical, simulate_all(physical, choice.best).predicted)
        less = held_out_squares(physical, simulate_all(physical, before.best).predicted)
        if less - error > CONFIRMED:
            break
        block, kind, _ = choice.rounds[-1][0].label
        refused.append(Refused(block, kind, f"{kind.replace('_', ' ').capitalize()}: {UNCONFIRMED}."))
        choice = before
    return replace(physical, choice=choice), tuple(refused)


def _without_last(choice: Choice) -> Choice:
    rounds = choice.rounds[:-1]
    return Choice(choice.base, rounds[-1][0].fitted if rounds else choice.base, rounds, choice.limits)
