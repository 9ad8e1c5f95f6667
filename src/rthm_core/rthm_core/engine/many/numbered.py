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
    latched : (E,) array
        Which are samples that the numerical side latches: of others nobody asks the velocity.
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
    latched: Flags
    steps: tuple[Integers, Integers]
    rings: tuple[Integers, Integers]
    lengths: tuple[Floats, Floats]
    sizes: tuple[int, int]
    period: int


@kept_by_clocks
def numbered(spec: Spec, step: int) -> Numbered | None:
    """Program with a row every `step` ns of as many hyperperiods as it looks back on; None where nothing
    repeats.
    """
    found = repeating_program(spec, step)
    if found is None:
        return None
    first, further, period = found
    makes, backs = (first.what == SAMPLE, first.what == REFERENCE), (first.sample, first.reference)
    times = max(-(-int(back.max()) // max(1, int(one.sum()))) for one, back in zip(makes, backs, strict=True))
    times = max(times, 1)
    rings = [_ring(np.tile(one, times), np.tile(back, times)) for one, back in zip(makes, backs, strict=True)]
    (samples, sampled), (references, referred) = rings
    steps1, lengths1 = _steps(first.plant, further.plant, times)
    steps2, lengths2 = _steps(first.numerical, further.numerical, times)
    return Numbered(
        np.tile(first.what, times),
        _latched(np.tile(first.what, times), np.tile(first.sample, times)),
        (steps1, steps2),
        (sampled, referred),
        (lengths1, lengths2),
        (samples, references),
        period * times,
    )


def _steps(first: Integers, further: Integers, times: int) -> tuple[Integers, Floats]:
    """Numbers (2, E) of the steps of a program, that many times after one another; their lengths in s."""
    every = np.stack([np.concatenate([first, *[further] * (times - 1)]), np.tile(further, times)])
    lengths, which = np.unique(every, return_inverse=True)
    return which.reshape(every.shape), np.asarray(lengths * 1e-9, dtype=float)


def _latched(what: Integers, back: Integers) -> Flags:
    """Which operations are samples that the numerical side latches."""
    makes = what == SAMPLE
    number: Integers = np.cumsum(makes) - makes
    used = np.zeros(max(1, int(np.count_nonzero(makes))), dtype=bool)
    used[(number - back)[what == REFERENCE] % used.size] = True
    return np.asarray(makes & used[number % used.size])


def _ring(makes: Flags, back: Integers) -> tuple[int, Integers]:
    """Length of a ring that is full whenever a program ends, and where in it an operation finds what it uses,
    so many places back from the newest, or puts what it makes.
    """
    made, reach = max(1, int(np.count_nonzero(makes))), max(1, int(back.max()))
    length = next((one for one in range(reach, made + 1) if made % one == 0), reach)
    number: Integers = np.cumsum(makes) - makes
    return length, np.where(makes, number, number - back) % length


def in_memory(program: Numbered, room: Room, m: int) -> Integers:
    """The program as the kernel takes it, by places in the memory of a room."""
    (one, two), (sampled, referred) = program.steps, program.rings
    size1, size2 = (steps[0].size for steps in (room.steps1, room.steps2))
    columns = (
        program.what,
        one * size1,
        np.where(program.what == SAMPLE, program.latched, two * size2 + room.steps1.size),
        room.samples + sampled * (2 * m * WIDTH),
        room.references + referred * (m * WIDTH),
    )
    operations = np.empty((*one.shape, len(columns)), dtype=np.int32)
    for i, column in enumerate(columns):
        operations[..., i] = column
    return operations.ravel()
