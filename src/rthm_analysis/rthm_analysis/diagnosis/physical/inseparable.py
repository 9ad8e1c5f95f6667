"""What no recording of a motion tells apart, in words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping

from rthm_analysis.diagnosis.criteria.words import ALIKE_CHANGE, ALIKE_STDS
from rthm_analysis.diagnosis.numbers import bare
from rthm_analysis.diagnosis.result import Alternative, Described, Physics, Retuned, Value
from rthm_analysis.diagnosis.words import block_words
from rthm_core.effects import effect

LOAD_TERM = re.compile(r"(^|[+-] )-?[\d.e+-]+ \* load( [+-] |$)")
"""Of a formula: what goes with the known load alone."""

WITH_LOAD = (
    "A part of a force that goes with the known load is the same as another gain of the load cell, or of all "
    "sensors of the motion, where the other forces are larger by as much: this recording does not tell "
    "which. Put a known force on the load cell, and move the rig by a known distance."
)


def inseparable(physics: Iterable[Physics]) -> Iterator[str]:
    """A constant force beside dry friction of a dof: the same as friction that differs with the direction.

    Parameters
    ----------
    physics : iterable of Physics
        What was named.

    Yields
    ------
    str
        What is the same in motion, with sizes, and how to find out.
    """
    of_plant = [one for one in physics if one.block == "plant"]
    for offset in of_plant:
        if effect(offset.kind, "plant").depends_on:
            continue
        for rubbing in of_plant:
            if rubbing.place == offset.place and effect(rubbing.kind, "plant").jump:
                yield _words(str(offset.place), _size(offset), _size(rubbing))


def gains(physics: Iterable[Physics], forces: Iterable[Described]) -> Iterator[str]:
    """A force that goes with the known load, alone or beside others that are larger by as much: the same as a
    gain.

    Parameters
    ----------
    physics : iterable of Physics
        What was named.
    forces : iterable of Described
        What was described, in a plant under known forces.

    Yields
    ------
    str
        What is the same, and how to find out.
    """
    every = list(forces)
    if list(physics) or len(every) != 1:
        return
    (force,) = every
    if LOAD_TERM.search(force.formula or "") and set(force.depends_on) != {"load"}:
        yield WITH_LOAD
    elif force.block == "plant" and "load" in force.depends_on and set(force.depends_on) <= {"load", "t"}:
        when = " that changes with time" if "t" in force.depends_on else ""
        yield (
            f"In a linear rig a force that goes with the known load is the same as another gain{when} of the "
            "load cell, or of all sensors of the motion: this recording does not tell which. Put a known "
            "force on the load cell, and move the rig by a known distance."
        )


def all_alike(retuned: Mapping[str, Retuned]) -> Iterator[str]:
    """Mass, damping and stiffness that are all off by one factor, under a known force: the same as a gain.

    Parameters
    ----------
    retuned : mapping of Retuned
        New values of a plant with one dof.

    Yields
    ------
    str
        What is the same, and how to find out.
    """
    found = [retuned.get(f"plant.{name}") for name in ("mass", "damping", "stiffness")]
    known = [one for one in found if one is not None and one.nominal]
    if len(known) < len(found):
        return
    ratios = [one.value / one.nominal for one in known]
    stds = [one.std / abs(one.nominal) for one in known]
    reach = max(ALIKE_STDS * max(stds), ALIKE_CHANGE)
    if max(ratios) - min(ratios) < reach < 0.5 * abs(ratios[0] - 1.0):
        factor = bare(ratios[0], 4)
        yield (
            f"Mass, damping and stiffness are all {factor} times those of the spec, which is the same "
            "as another gain of the load cell, or of all sensors of the motion: this recording does not tell "
            "which. Put a known force on the load cell, and move the rig by a known distance."
        )


def elsewhere(physics: Iterable[Physics], alternatives: Iterable[Alternative]) -> Iterator[str]:
    """Kinds in another block that explain the recording as well as the only one that was named.

    Parameters
    ----------
    physics : iterable of Physics
        What was named.
    alternatives : iterable of Alternative
        What else was tried.

    Yields
    ------
    str
        What it may be instead.
    """
    named = list(physics)
    if len(named) != 1:
        return
    (one,) = named
    for other in alternatives:
        if other.block != one.block and not other.distinguishable:
            yield (
                f"Instead of {_kind_words(one)} it may as well be {_kind_words(other)}: "
                "this recording does not tell which."
            )


def _kind_words(one: Physics | Alternative) -> str:
    return f"{one.kind.replace('_', ' ')} of {block_words(one.block)}"


def _size(one: Physics) -> float:
    """Size of a constant force, or of dry friction in motion, N."""
    law = effect(one.kind, "plant")
    key = law.jump or next(iter(law.parameters))
    value = one.parameters[key]
    assert isinstance(value, Value)
    return value.value


def _words(dof: str, offset: float, friction: float) -> str:
    ahead, back = bare(friction - offset), bare(friction + offset)
    return (
        f"While {dof} moves, a constant force of {bare(offset)} N beside dry friction of {bare(friction)} N "
        f"is the same as friction of {ahead} N towards +x and {back} N towards -x, or as an offset of what "
        f"drives it: this recording does not tell which. At rest they differ: find the forces at which {dof} "
        "begins to move, both ways."
    )
