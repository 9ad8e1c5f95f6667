"""A program that many loops share: what happens in it, by the number of each step and by places in rings."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.compiled import Flags, Floats, Integers
from rthm_core.engine.linear.run import repeating_program
from rthm_core.engine.many.lanes import Room
from rthm_core.kept import kept_by_clocks
from rthm_core.schedule import REFERENCE, SAMPLE
from rthm_core.simd import WIDTH

if TYPE_CHECKING:
    from rthm_core.spec import Spec


class Numbered(NamedTuple):
    """A program that repeats.

    Attributes
    ----------
    what : (E,) array
    steps : tuple of (2, E) arrays
        Numbers of the steps of the plant and of the numerical side, in the first and in every further pass.
    rings : tuple of (E,) arrays
        Places of samples and of references in their rings.
    lengths : tuple of (K,) arrays
        Of the steps of both sides, in s.
    sizes : tuple of int
        Places that the rings have.
    period : int
        Length of a pass in ns.
    """

    what: Integers
    steps: tuple[Integers, Integers]
    rings: tuple[Integers, Integers]
    lengths: tuple[Floats, Floats]
    sizes: tuple[int, int]
    period: int


@kept_by_clocks
def numbered(spec: Spec, step: int) -> Numbered | None:
    """Program of one hyperperiod with a row every `step` ns; None where nothing repeats."""
    found = repeating_program(spec, step)
    if found is None:
        return None
    first, further, period = found
    lengths1, which1 = np.unique(np.stack([first.plant, further.plant]), return_inverse=True)
    lengths2, which2 = np.unique(np.stack([first.numerical, further.numerical]), return_inverse=True)
    samples, sampled = _ring(first.what == SAMPLE, first.sample)
    references, referred = _ring(first.what == REFERENCE, first.reference)
    return Numbered(
        first.what,
        (which1.reshape(2, -1), which2.reshape(2, -1)),
        (sampled, referred),
        (np.asarray(lengths1 * 1e-9, dtype=float), np.asarray(lengths2 * 1e-9, dtype=float)),
        (samples, references),
        period,
    )


def _ring(makes: Flags, back: Integers) -> tuple[int, Integers]:
    """Length of a ring that is full whenever a program ends, and where in it an operation finds what it uses,
    so many places back from the newest, or puts what it makes.
    """
    made, reach = max(1, int(np.count_nonzero(makes))), max(1, int(back.max()))
    whole = -(-reach // made) * made
    length = next((one for one in range(reach, whole) if made % one == 0), whole)
    number: Integers = np.cumsum(makes) - makes
    return length, np.where(makes, number, number - back) % length


def in_memory(program: Numbered, room: Room, m: int) -> Integers:
    """The program as the kernel takes it, by places in the memory of a room."""
    (one, two), (sampled, referred) = program.steps, program.rings
    size1, size2 = (steps[0].size for steps in (room.steps1, room.steps2))
    columns = (
        program.what,
        one * size1,
        two * size2 + room.steps1.size,
        room.samples + sampled * (2 * m * WIDTH),
        room.references + referred * (m * WIDTH),
    )
    operations = np.empty((*one.shape, len(columns)), dtype=np.int32)
    for i, column in enumerate(columns):
        operations[..., i] = column
    return operations.ravel()
