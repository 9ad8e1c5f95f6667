"""How a loop changes with parameters of its spec: derivatives of its matrices, held forces and start.

The matrices are smooth in every parameter, so that differences of them are as good as formulas, and no
formula of the physics is written a second time. The last two axes of every array are the parameters, in
groups of `WIDTH`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rthm_core.compiled import Flags, Floats, Integers
from rthm_core.engine.nonlinear.loop import NonlinearLoop, nonlinear_loop
from rthm_core.errors import InputError
from rthm_core.physical.laws import CODE, FRICTION, PARTITION, law_of
from rthm_core.simd import WIDTH, simd_copy, simd_empty
from rthm_core.spec import apply, number_at

if TYPE_CHECKING:
    from rthm_core.spec import Spec

TANGENT_STEP = 1e-5
"""Step of the differences, relative to the parameter; absolute where that is zero."""

Unsigned = NDArray[np.uint64]
"""Array of indices; shapes are in the docstrings."""

Stencil = list[tuple["Spec", float]]
"""Specs beside the given one, and the weight of each in the derivative."""


class Tangents(NamedTuple):
    """Derivatives with respect to parameters, of what `Nonlinear`, `Looks` and `NonlinearLoop` hold.

    The last two axes, Q groups of 8 lanes, are the parameters; the lane after the last of them is the motion
    itself. There matrices and limits are zero, since these do not change, and all else is as it is.

    Attributes
    ----------
    systems, holds : (S, N, d, Q, 8), (S, L, d, Q, 8) arrays
    forces : (L, 3, Q, 8) array
        Force of each law in its modes -1, 0 and 1.
    breakaway : (L, Q, 8) array
    sample, force, reference : (N + M, ., Q, 8) arrays
        Of the transposed matrices.
    bias, k_tot : (2 m, Q, 8), (m, Q, 8) arrays
    start : (N + M, Q, 8) array
    first_sample, first_reference : (2 m, Q, 8), (m, Q, 8) arrays
    """

    systems: Floats
    holds: Floats
    forces: Floats
    breakaway: Floats
    sample: Floats
    force: Floats
    reference: Floats
    bias: Floats
    k_tot: Floats
    start: Floats
    first_sample: Floats
    first_reference: Floats


def stencil(spec: Spec, name: str) -> Stencil:
    """Second-order difference with respect to a parameter: central, or forward from a lower bound.

    Raises
    ------
    InputError
        When the spec has no such number, or it may not move.
    """
    value = number_at(spec, name)
    if value is None:
        raise InputError(f"{name} is not a number of this spec; name one that it has, as plant.mass.")
    step = TANGENT_STEP * (abs(value) or 1.0)
    try:
        below = apply(spec, {name: value - step})
    except InputError:
        ahead = [apply(spec, {name: value + i * step}) for i in (1, 2)]
        return [(spec, -1.5 / step), (ahead[0], 2.0 / step), (ahead[1], -0.5 / step)]
    return [(apply(spec, {name: value + step}), 0.5 / step), (below, -0.5 / step)]


def tangents(spec: Spec, loop: NonlinearLoop, names: Sequence[str]) -> Tangents | None:
    """Derivatives of a loop; None where a small change of a parameter changes what the loop is made of."""
    shapes, derivatives = [one.shape for one in _arrays(loop)], []
    for name in names:
        weighted = []
        for beside, weight in stencil(spec, name):
            changed = nonlinear_loop(beside, energies=loop.forms.size > 0)
            arrays = () if changed is None else _arrays(changed)
            if [one.shape for one in arrays] != shapes:
                return None
            weighted.append([weight * one for one in arrays])
        derivatives.append([np.sum(parts, axis=0) for parts in zip(*weighted, strict=True)])
    motion = _motion(loop)
    return Tangents(*(_lanes(parts, own) for *parts, own in zip(*derivatives, motion, strict=True)))


def _motion(loop: NonlinearLoop) -> list[Floats]:
    """Lane of the motion, in the order of `Tangents`."""
    themselves = ("forces", "bias", "start", "first_sample", "first_reference")
    arrays = zip(Tangents._fields, _arrays(loop), strict=True)
    return [one if name in themselves else np.zeros_like(one) for name, one in arrays]


def _lanes(derivatives: Sequence[Floats], motion: Floats) -> Floats:
    """Arrays stacked along a last axis that is filled up to whole groups, and parted into them."""
    groups = len(derivatives) // WIDTH + 1
    missing = groups * WIDTH - len(derivatives) - 1
    stacked = np.stack([*derivatives, motion, *([np.zeros_like(motion)] * missing)], axis=-1)
    return simd_copy(stacked.reshape(*motion.shape, groups, WIDTH))


def _arrays(loop: NonlinearLoop) -> tuple[Floats, ...]:
    """What of a loop depends on parameters, in the order of `Tangents`."""
    nonlinear, linear = loop.nonlinear, loop.linear
    return (
        nonlinear.systems,
        nonlinear.holds,
        _forces(nonlinear.laws.numbers, nonlinear.laws.parameters),
        nonlinear.laws.breakaway,
        loop.sample.T,
        loop.force.T,
        loop.reference.T,
        linear.bias,
        linear.k_tot,
        loop.start,
        linear.first_sample,
        linear.first_reference,
    )


def _forces(numbers: Integers, parameters: Floats) -> Floats:
    """Force (L, 3) in the modes -1, 0 and 1 of laws that are constant in each."""
    found = np.zeros((numbers.shape[0], 3))
    for row, (law, p) in enumerate(zip(numbers, parameters, strict=True)):
        of_mode: Any = law_of(law[CODE]).force
        for mode in (-1, 1):
            found[row, mode + 1] = of_mode(0.0, 0.0, [], 0.0, p, mode)
        assert law[PARTITION] == FRICTION
    return found


class Pairs(NamedTuple):
    """Matrices and their changes, two rows at a time, as `by_pairs` takes them.

    Attributes
    ----------
    columns : (N / 2, .) array
        Number of elements that count, and then these. Unsigned, since compiled code need not ask whether such
        an index counts from the end.
    values, changes : (K, N / 2, ., 2), (K, N / 2, ., 2, Q, 8) arrays
    """

    columns: Unsigned
    values: Floats
    changes: Floats


def step_pairs(loop: NonlinearLoop, changes: Tangents, slots: int) -> Pairs:
    """Memory for the matrices of so many steps, which are made when they are needed."""
    systems = np.abs(loop.nonlinear.systems).sum(axis=0) + np.abs(changes.systems).sum(axis=(0, 3, 4))
    n = systems.shape[0]
    states = np.eye(n, dtype=bool)
    for _ in range(n):
        states = states | (states.astype(int) @ (systems[:, :n] != 0.0) > 0)
    columns = _numbered(np.hstack([states, states.astype(int) @ (systems[:, n:] != 0.0) > 0]))
    values = np.empty((slots, *columns.shape, 2))
    return Pairs(columns, values, simd_empty(*values.shape, *changes.systems.shape[-2:]))


def look_pairs(rows: Floats, changes: Floats) -> Pairs:
    """What is seen of [y, held] through `rows` (., N + M), with their transposed `changes`."""
    columns = _numbered((rows != 0.0) | np.any(changes != 0.0, axis=(2, 3)).T)
    which = np.minimum(2 * np.arange(columns.shape[0])[:, None] + [0, 1], rows.shape[0] - 1)
    taken = columns.astype(int)[:, :, None], which[:, None]
    return Pairs(columns, np.ascontiguousarray(rows.T[taken][None]), simd_copy(changes[taken][None]))


def _numbered(rows: Flags) -> Unsigned:
    """Number of columns that are true in either of two rows, and then their indices."""
    rows = np.logical_or.reduceat(rows, np.arange(0, rows.shape[0], 2))
    found = np.zeros((rows.shape[0], 1 + rows.sum(axis=1).max()), dtype=np.uint64)
    for i, row in enumerate(rows):
        which = np.flatnonzero(row)
        found[i, 0], found[i, 1 : 1 + which.size] = which.size, which
    return found
