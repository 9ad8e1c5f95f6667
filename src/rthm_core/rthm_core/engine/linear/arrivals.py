"""What a command adds that arrives between two instants of the clocks: to the state at the later one, and to
the work until then.

A linear loop moves from instant to instant as if no command arrived, and each that did adds its response: the
lengths between instants of clocks are few, so that every other length comes in here alone. What depends on it
is kept as polynomials over short pieces, exact to rounding.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers
from rthm_core.energy import TERMS
from rthm_core.engine.linear.ledger import COLUMNS, LinearLedger, packed, work_over
from rthm_core.engine.linear.loop import LinearLoop, Side
from rthm_core.engine.linear.vectors import Vector, vector
from rthm_core.exponential import exponentials, rate_bound
from rthm_core.simd import WIDTH, simd_empty

FEWEST_PIECES, MOST_PIECES = 16, 512
"""Of a length, each with polynomials of its own."""

LONGEST_PIECE = 0.05
"""Length of a piece, in time constants of the fastest motion."""

TERMS_KEPT = 8
"""Coefficients of a response: so many are exact to rounding in the longest piece."""


class Responses(NamedTuple):
    """What a command adds until a time after it has arrived.

    Attributes
    ----------
    scale : float
        Pieces per ns.
    centres : (K,) array
        Middle of each piece, in whole ns.
    terms : (K, P, M, n) array
        State of the plant after a unit step of each of its inputs: coefficients of the powers of the distance
        from the middle, in half pieces.
    change : vector
        Of the length of these inputs.
    """

    scale: float
    centres: Integers
    terms: Floats
    change: Vector


class Works(NamedTuple):
    """Work where commands arrive, in pieces as those of `Responses`; d is the length of the joint state.

    Attributes
    ----------
    tables : (L, d (d + 1) / 2, 8) array
        Work over each length between two instants of the clocks, as if no command arrived.
    steps : (K, P, d, ., 8) array
        The joint state a time later, for each element of it.
    added : (K, Q, d M, 8) array
        Work for each product of an element of the joint state when a command arrives, in which the command is
        the mean of what it was and becomes, and of a change of an input.
    energy : (d (d + 1) / 2,) array
        Total energy of the present joint state.
    sums : (1, 8) array
        Work so far.
    z, later, products : (d,), (., 8), (d M,) arrays
        Scratch: joint states, and their products with the changes of the inputs.
    """

    tables: Floats
    steps: Floats
    added: Floats
    energy: Floats
    sums: Floats
    z: Floats
    later: Floats
    products: Floats


class _Pieces(NamedTuple):
    """Middles in ns (K,), half the length of each in s."""

    centres: Integers
    half: float


def _pieces(rate: float, longest: int) -> _Pieces | None:
    """Pieces of the lengths up to `longest` ns where nothing is faster than `rate` (1/s); None: too many."""
    count = max(FEWEST_PIECES, math.ceil(rate * longest * 1e-9 / LONGEST_PIECE))
    if count > MOST_PIECES:
        return None
    width = longest / count
    return _Pieces(np.rint((np.arange(count) + 0.5) * width).astype(np.int64), 0.5e-9 * width)


def _count(x: float) -> int:
    """How many terms of the exponential series of `x` count, and one for what is an integral of it."""
    count, size = 1, x
    while size > 1e-17:
        count += 1
        size *= x / count
    return count + 1


def _joint(side: Side) -> Floats:
    """Dynamics of [state, held inputs]."""
    n, m = side.b.shape
    joint = np.zeros((n + m, n + m))
    joint[:n, :n], joint[:n, n:] = side.a, side.b
    return joint


def _step_terms(joint: Floats, pieces: _Pieces, count: int) -> Floats:
    """Coefficients (K, count, d, d) of the step matrices."""
    terms = [exponentials(joint, pieces.centres)]
    for k in range(1, count):
        terms.append(terms[-1] @ joint * (pieces.half / k))
    return np.stack(terms, axis=1)


def responses(loop: LinearLoop, longest: int, rate: float) -> Responses | None:
    """Responses up to `longest` ns in a loop without motion faster than `rate` (1/s); None where there are no
    fast ones.
    """
    pieces, n = _pieces(rate, longest), loop.plant.a.shape[0]
    if pieces is None:
        return None
    terms = _step_terms(_joint(loop.plant), pieces, TERMS_KEPT)
    added = np.ascontiguousarray(np.swapaxes(terms[:, :, :n, n:], 2, 3))
    change = vector(np.zeros(loop.plant.held.size))
    return Responses(pieces.centres.size / longest, pieces.centres, added, change)


def rate_of(loop: LinearLoop, ledger: LinearLedger | None) -> float:
    """What nothing that `responses` and `works` describe is faster than, 1/s."""
    return rate_bound(_joint(loop.plant)) if ledger is None else 2.0 * rate_bound(ledger.joint)


def works(ledger: LinearLedger, tables: Floats, longest: int, rate: float) -> Works | None:
    """Work where commands arrive, with its tables between instants; None where `responses` gives none."""
    pieces, joint, plant = _pieces(rate, longest), ledger.joint, ledger.loop.plant
    if pieces is None:
        return None
    d, (n, inputs), count = joint.shape[0], plant.b.shape, _count(rate * pieces.half)
    steps = _step_terms(joint, pieces, count)
    return Works(
        tables,
        _in_groups(np.swapaxes(steps, 2, 3)),
        _added(_work_terms(ledger, pieces, steps[:, 0], count), slice(n, n + inputs)),
        packed(ledger.forms[None, -1:])[0, :, 0].copy(),
        np.zeros((1, COLUMNS)),
        np.zeros(d),
        simd_empty(-(-d // WIDTH), WIDTH),
        np.zeros(d * inputs),
    )


def _in_groups(values: Floats) -> Floats:
    """Array whose last axis is filled with zeros up to whole SIMD values."""
    *shape, last = values.shape
    groups = -(-last // WIDTH)
    padded = simd_empty(*shape, groups * WIDTH)
    padded[..., :last], padded[..., last:] = values, 0.0
    return padded.reshape(*shape, groups, WIDTH)


def _work_terms(ledger: LinearLedger, pieces: _Pieces, steps: Floats, count: int) -> Floats:
    """Coefficients (K, count, 6, d, d) of the work over a length as forms of the state at its start, with the
    `steps` (K, d, d) to the middle of each piece.

    The rate of the work after a time is the power there, ``E' P E``, whose own rate is ``A' G + G A``.
    """
    joint, powers = ledger.joint, ledger.forms[: len(TERMS)]
    terms = [work_over(ledger, pieces.centres)]
    rate = np.swapaxes(steps, 1, 2)[:, None] @ powers @ steps[:, None]
    for k in range(1, count):
        terms.append(rate * (pieces.half / k))
        rate = (joint.T @ rate + rate @ joint) * (pieces.half / k)
    return np.stack(terms, axis=1)


def _added(forms: Floats, inputs: slice) -> Floats:
    """Work (K, P, d M, 8) for products of the state and changes of the `inputs`, from symmetric `forms`
    (K, P, 6, d, d).
    """
    pieces, count, terms = forms.shape[:3]
    columns = 2.0 * np.moveaxis(forms[..., inputs], 2, -1)
    return _in_groups(columns.reshape(pieces, count, -1, terms))[..., 0, :]
