"""Memory of tangents that follow a motion whose forces change within a step."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers
from rthm_core.engine.nonlinear.loop import NonlinearLoop
from rthm_core.engine.nonlinear.steps import ORDERS
from rthm_core.engine.tangents.advance import Term
from rthm_core.engine.tangents.changes import Tangents
from rthm_core.engine.tangents.entries import (
    PAIRS,
    Entries,
    Look,
    entries,
    in_blocks,
    look_entries,
    of_steps,
)
from rthm_core.engine.tangents.polynomial import STAGES
from rthm_core.engine.tangents.slopes import Slopes
from rthm_core.simd import WIDTH, simd_copy, simd_empty


class FollowedSteps(NamedTuple):
    """Matrices of steps by slot (K) as in `Packed`, and looks.

    Attributes
    ----------
    after, stages : Entries
        State at the end of each step, and what is felt after each third, from what describes the step.
    influence : (K, stages F, stages G) array
        How what is felt depends on the forces after each third.
    filled : (K,) array
        Which are there; the last is for any other length.
    row : Look
    sample, reference : Entries
        What is seen of z.
    """

    after: Entries
    stages: Entries
    influence: Floats
    filled: Integers
    row: Look
    sample: Entries
    reference: Entries


class FollowedWork(NamedTuple):
    """What lasts from step to step, and scratch.

    Attributes
    ----------
    halves : (3, d + 3 G, Q, 8) array
        Tangents of what describes a step, at its beginning and at its end in turns, and those of a part.
    lanes, width : (3 (d + 3 G) Q 8,) array, int
        The same memory, and how long a row of it is.
    samples, references : (length 2 m Q 8,), (length m Q 8,) arrays
        Those of the memory.
    now : (d,) array
        z on the way through an arc.
    felt, felt_lanes : (stages F, Q, 8), (stages F Q 8,) arrays
        Tangents of what is felt after each third, once without the forces there; the same memory.
    matrix, forces : (stages G, stages G), (stages G, Q, 8) arrays
        System for those of the forces after each third, and these.
    ask : Slopes
    rate, shift : (d,), (Q, 8) arrays
        Of [y, held, g] just before a law switches, and how much later it does per unit of each parameter.
    one, other : Term
        Of [y, held, g].
    unit, zero : (d + 3 G,), (d + 3 G, Q, 8) arrays
        `zero` is never written.
    column, after_change : (stages, N, Q, 8), (d + 3 G, N, Q, 8) arrays
    stage_change, stage_matrix : (d + 3 G, stages F, Q, 8), (d + 3 G, stages F) arrays
    """

    halves: Floats
    lanes: Floats
    width: int
    samples: Floats
    references: Floats
    now: Floats
    felt: Floats
    felt_lanes: Floats
    matrix: Floats
    forces: Floats
    ask: Slopes
    rate: Floats
    shift: Floats
    one: Term
    other: Term
    unit: Floats
    zero: Floats
    column: Floats
    after_change: Floats
    stage_change: Floats
    stage_matrix: Floats


def followed_steps(
    loop: NonlinearLoop, changes: Tangents, rows: Floats, moved: Floats, slots: int
) -> tuple[FollowedSteps, Integers]:
    """Memory for so many steps and for what is seen of z through `rows`, with transposed changes `moved`; the
    order in which these are written.
    """
    felt, g = loop.nonlinear.felt, loop.nonlinear.weight.size
    pattern, touched = of_steps(loop, changes)
    pattern = np.hstack([pattern, *[pattern[:, pattern.shape[1] - g :]] * (ORDERS - 1)])
    stages, every = np.tile(felt, STAGES), look_entries(rows, moved)
    order = np.array(list(dict.fromkeys(every.rows.ravel().tolist())))
    rows, moved = rows[order], simd_copy(moved[:, order])
    none = entries(pattern[:0], touched[:0], 1, np.zeros((0, 3), dtype=np.int64))
    empty = np.empty((0, 0)), simd_empty(0, 0, *moved.shape[2:])
    found = FollowedSteps(
        entries(pattern, touched, slots, in_blocks(pattern, PAIRS)[1]),
        entries(pattern[stages], touched[stages], slots, in_blocks(pattern[stages], PAIRS)[1]),
        np.zeros((slots, stages.size, STAGES * g)),
        np.zeros(slots, dtype=np.int64),
        Look(rows, moved, none, look_entries(rows, moved), *empty),
        look_entries(loop.sample, changes.sample),
        look_entries(loop.reference, changes.reference),
    )
    return found, order


def followed_work(
    loop: NonlinearLoop, changes: Tangents, ask: Slopes, samples: Floats, references: Floats
) -> FollowedWork:
    """Tangents at the start of a test that looks back on some samples and references."""
    _, n, d, *groups = changes.systems.shape
    g, f = loop.nonlinear.weight.size, STAGES * loop.nonlinear.felt.size
    whole = d + (ORDERS - 1) * g
    halves, felt = simd_copy(np.zeros((3, whole, *groups))), simd_copy(np.zeros((f, *groups)))
    halves[:2, : changes.start.shape[0]] = changes.start
    return FollowedWork(
        halves,
        halves.reshape(-1),
        groups[0] * WIDTH,
        simd_copy(samples).reshape(-1),
        simd_copy(references).reshape(-1),
        np.zeros(d),
        felt,
        felt.reshape(-1),
        np.zeros((STAGES * g, STAGES * g)),
        simd_empty(STAGES * g, *groups),
        ask,
        np.zeros(d),
        simd_empty(*groups),
        Term(np.zeros(d), simd_empty(d, *groups)),
        Term(np.zeros(d), simd_empty(d, *groups)),
        np.zeros(whole),
        simd_copy(np.zeros((whole, *groups))),
        simd_empty(STAGES, n, *groups),
        simd_empty(whole, n, *groups),
        simd_empty(whole, f, *groups),
        np.zeros((whole, f)),
    )
