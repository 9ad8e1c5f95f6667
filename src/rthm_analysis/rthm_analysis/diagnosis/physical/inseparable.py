"""What no recording of a motion tells apart, in words: effects that only at rest are not the same."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rthm_analysis.diagnosis.numbers import bare
from rthm_analysis.diagnosis.result import Physics, Value
from rthm_core.effects import effect


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
