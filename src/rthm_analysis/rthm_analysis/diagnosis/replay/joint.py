"""Several recordings of one rig as one: a model is shared, and each begins in a state of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.replay import JOINT_MOTORS_PAUSE_S, JOINT_PAUSE_SAMPLES
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_core.clock import NS
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers


def one_after_the_other(evidences: Sequence[Evidence], names: Sequence[str], first: Floats) -> Evidence:
    """Evidence of several recordings, one after the other with a pause between them.

    Parameters
    ----------
    evidences : sequence of Evidence
        At least one; the last confirms what the others show.
    names : sequence of str
        Of the recordings.
    first : (m,) array
        Command in steady state before each test, m: the motors go back to it in the pause.

    Returns
    -------
    Evidence
        With the channels that all have; notes say which others there were.

    Raises
    ------
    InputError
        When they have no channel in common, or commands drive some and known forces others.
    """
    if len(evidences) == 1:
        return evidences[0]
    alike, notes = _alike(evidences)
    begins = np.cumsum([0, *(one.stamps_ns.size for one in alike[:-1])])
    offsets = _offsets(alike)
    due, commands = _commands(alike, offsets, first)
    where = [f"{name} from {by / NS:.4g} s" for name, by in zip(names, offsets, strict=True)]
    times = f"Times count through all recordings, one after the other: {', '.join(where)} on."
    return replace(
        alike[0],
        stamps_ns=np.concatenate([one.stamps_ns + by for one, by in zip(alike, offsets, strict=True)]),
        due_ns=due,
        commands=commands,
        load=np.concatenate([one.load for one in alike]),
        measured=np.concatenate([one.measured for one in alike]),
        notes=tuple(dict.fromkeys([*(note for one in alike for note in one.notes), *notes, times])),
        under_way=max(one.under_way for one in alike),
        begins=tuple(int(one) for one in begins),
        names=tuple(names),
    )


def _alike(evidences: Sequence[Evidence]) -> tuple[list[Evidence], list[str]]:
    """The same with the channels that all have, in one order, and what was left out for that."""
    if len({one.driven_by for one in evidences}) > 1:
        raise InputError(
            "some recordings have commands and some have only forces, so they are not of one rig; diagnose "
            "them in two calls."
        )
    common = [one for one in evidences[0].channels if all(one in other.channels for other in evidences)]
    if not common:
        raise InputError("the recordings have no signal in common; diagnose them one by one.")
    beyond = dict.fromkeys(c for one in evidences for c in one.channels if c not in common)
    notes = [f"The {c.family} of {c.place} is not in all recordings and was left out." for c in beyond]
    columns = [[one.channels.index(channel) for channel in common] for one in evidences]
    alike = [
        replace(one, channels=tuple(common), measured=one.measured[:, kept])
        for one, kept in zip(evidences, columns, strict=True)
    ]
    return alike, notes


def _offsets(alike: list[Evidence]) -> list[int]:
    """When each begins, ns: motors have the time to go back, a plant alone only stands apart."""
    offsets = [0]
    for one in alike[:-1]:
        pause = JOINT_PAUSE_SAMPLES * int(np.median(np.diff(one.stamps_ns)))
        if one.driven_by == "command":
            pause = max(pause, int(JOINT_MOTORS_PAUSE_S * NS))
        offsets.append(offsets[-1] + int(one.stamps_ns[-1]) + pause)
    return offsets


def _commands(alike: list[Evidence], offsets: list[int], first: Floats) -> tuple[Integers, Floats]:
    """When commands come, ns, and what they are: each pause begins with the one before the tests."""
    if alike[0].driven_by != "command":
        return alike[0].due_ns, alike[0].commands
    due, commands = [], []
    for one, by in zip(alike, offsets, strict=True):
        last = int(one.stamps_ns[-1])
        in_time = one.due_ns <= last
        due += [one.due_ns[in_time] + by, np.array([last + by + 1])]
        commands += [one.commands[in_time], first[None, :]]
    return np.concatenate(due), np.concatenate(commands)
