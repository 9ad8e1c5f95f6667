"""How forces of laws and wires change with the motion and with parameters, compiled.

They are smooth between their switches, so that central differences of a law by itself are as good as
formulas, and no law is written a second time. A law is asked about what it takes alone.
"""

from __future__ import annotations

import dis
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from rthm_core.compiled import Flags, Floats, Integers, inlined, whole
from rthm_core.engine.nonlinear.forces import drive_side, wire_force
from rthm_core.engine.nonlinear.loop import Nonlinear
from rthm_core.engine.tangents.changes import TANGENT_STEP, Tangents
from rthm_core.lent import given, lent
from rthm_core.physical.laws import (
    CODE,
    FRICTION,
    PARTITION,
    PLACE,
    STATE,
    STATES,
    law_of,
    plant_force,
    plant_rate,
)
from rthm_core.simd import element, everywhere, numbers, put_element, put_numbers, simd_empty

LEAST_PART, LEAST_SIZE = 1e-3, 1e-7
"""Least size that something which is changed counts as: a part of the largest that was seen of it, and that
of what was none.
"""

WIRE_STEP = 1e-4
"""Step of an end of a wire, relative to its elongation, which is a small difference of two positions."""

OF_POSITION, OF_VELOCITY, OF_STATE, OF_PARAMETER = range(4)
"""What a law is asked about: what its dof does, its own states, and its numbers."""

AT_DRIVE, AT_DOF, BY_SPEED, BY_STIFFNESS, BY_PARAMETER = range(5)
"""What a wire is asked about: where its ends are, the velocity of its dof, and its numbers."""


class Slopes(NamedTuple):
    """What forces are asked about, and what they answered last.

    Attributes
    ----------
    places : (F,) array
        Places in [y, held] of what they depend on; first come those that the laws feel.
    laws : (., 4) array
        Row of a law, what it is asked about, the place or the parameter, and where the place stands among
        `places`.
    wires : (., 4) array
        A wire, what it is asked about, and row and number of a parameter of its laws; for its drive, whether
        parameters change that.
    ends : (W, 2) array
        Where position and velocity of the wires' dofs stand among `places`.
    own : (L,) array
        Where among the forces the rates of a law's own states begin.
    parameters, wire_parameters : (L, 8), (R, 8) arrays
        Copies, to be changed.
    seen, elongation : (N + M,), (W,) arrays
        Largest size so far.
    answers : (2, G) array
        Scratch.
    slopes : (G, F) array
        Change of each force with each place.
    beside : (G, Q, 8) array
        What parameters change of each force by themselves.
    """

    places: Integers
    laws: Integers
    wires: Integers
    ends: Integers
    own: Integers
    parameters: Floats
    wire_parameters: Floats
    seen: Floats
    elongation: Floats
    answers: Floats
    slopes: Floats
    beside: Floats


def slopes(nonlinear: Nonlinear, tangents: Tangents) -> Slopes | None:
    """What the forces of a loop are asked about; None where wires may come to depend on other states."""
    laws, wires, size = nonlinear.laws, nonlinear.wires, nonlinear.systems.shape[1]
    driven = np.any(wires.drive != 0.0, axis=0) | np.any(tangents.drive != 0.0, axis=(0, 2, 3))
    held = np.setdiff1d(np.flatnonzero(driven), nonlinear.felt)
    if np.any(held < size):
        return None
    places = np.concatenate([nonlinear.felt, held])
    at = {int(place): i for i, place in enumerate(places)}
    moved = np.any(tangents.parameters != 0.0, axis=(2, 3))
    g, own = nonlinear.weight.size, laws.numbers[:, STATES]
    about_laws = [one for row in range(own.size) for one in _of_law(nonlinear, row, moved[row], at)]
    about_wires = [one for wire in range(wires.dof.size) for one in _of_wire(nonlinear, tangents, wire)]
    ends = [[at[dof], at[dof + nonlinear.n]] for dof in wires.dof.tolist()]
    return Slopes(
        places,
        _rows(about_laws, 4),
        _rows(about_wires, 4),
        _rows(ends, 2),
        own.size + np.cumsum(own) - own,
        laws.parameters.copy(),
        wires.parameters.copy(),
        np.zeros(nonlinear.systems.shape[2] - g),
        np.zeros(wires.dof.size),
        np.zeros((2, g)),
        np.zeros((g, places.size)),
        simd_empty(g, *tangents.start.shape[1:]),
    )


def _rows(rows: Sequence[Sequence[int]], width: int) -> Integers:
    return np.array(rows, dtype=np.int64).reshape(-1, width)


def _takes(functions: Sequence[Callable[..., Any]], name: str) -> bool:
    """Whether any function makes use of an argument."""
    for function in functions:
        code = getattr(function, "__code__", None)
        used = [] if code is None else [one.argval for one in dis.get_instructions(code)]
        if code is None or any(name == one or (isinstance(one, tuple) and name in one) for one in used):
            return True
    return False


def _of_law(nonlinear: Nonlinear, row: int, moved: Flags, at: dict[int, int]) -> Iterator[Sequence[int]]:
    """What a law is asked about, of whose parameters some are `moved`."""
    numbers = nonlinear.laws.numbers[row].tolist()
    law, dof, own = law_of(numbers[CODE]), numbers[PLACE], numbers[STATE]
    for name, what, place in (("x", OF_POSITION, dof), ("v", OF_VELOCITY, dof + nonlinear.n)):
        if _takes((law.force, law.rate), name):
            yield row, what, place, at[place]
    for place in range(own, own + numbers[STATES]):
        yield row, OF_STATE, place, at[place]
    for parameter in np.flatnonzero(moved).tolist():
        yield row, OF_PARAMETER, parameter, 0


def _of_wire(nonlinear: Nonlinear, tangents: Tangents, wire: int) -> Iterator[Sequence[int]]:
    """What a wire is asked about."""
    rows = np.flatnonzero(nonlinear.wires.laws[:, 1] == wire).tolist()
    yield wire, AT_DRIVE, int(np.any(tangents.drive[wire])), 0
    yield wire, AT_DOF, 0, 0
    if _takes([law_of(nonlinear.wires.laws[row, 0]).force for row in rows], "v"):
        yield wire, BY_SPEED, 0, 0
    if np.any(tangents.stiffness[wire]):
        yield wire, BY_STIFFNESS, 0, 0
    for row in rows:
        for parameter in np.flatnonzero(tangents.wire_parameters[row].any(axis=(1, 2))).tolist():
            yield wire, BY_PARAMETER, row, parameter


@inlined
def _add(beside, force, slope, change, index, groups):  # type: ignore[no-untyped-def]
    """Add what a force changes with a number, whose tangents are ``change[index]``."""
    for group in range(len(groups)):
        total = numbers(beside, (force, group)) + numbers(change, (*index, group)) * slope
        put_numbers(beside, (force, group), total)


@inlined
def _size(value, seen):  # type: ignore[no-untyped-def]
    """Size of a place, of which so much was seen."""
    size = max(abs(value), LEAST_PART * seen)
    return size if size > 0.0 else LEAST_SIZE


@inlined
def _law(nonlinear, change, ask, found, beside, e, y, t, mode, groups):  # type: ignore[no-untyped-def]
    """What changes by one of the things that laws are asked about."""
    rows, answers, laws = nonlinear.laws.numbers, ask.answers, ask.laws
    row, what = element(laws, (e, 0)), element(laws, (e, 1))
    index, column = element(laws, (e, 2)), element(laws, (e, 3))
    code, dof, own = element(rows, (row, CODE)), element(rows, (row, PLACE)), element(ask.own, (row,))
    first, states, p = element(rows, (row, STATE)), element(rows, (row, STATES)), ask.parameters[row]
    x, v, by_x, by_v = element(y, (dof,)), element(y, (dof + nonlinear.n,)), 0.0, 0.0
    z = y[first : first + states]
    value = element(p, (index,)) if what == OF_PARAMETER else element(y, (index,))
    size = abs(value) if what == OF_PARAMETER else _size(value, element(ask.seen, (index,)))
    step = TANGENT_STEP * (size if size > 0.0 else 1.0)
    for side in range(2):
        by = step if side == 0 else -step
        if what == OF_POSITION:
            by_x = by
        elif what == OF_VELOCITY:
            by_v = by
        elif what == OF_STATE:
            put_element(y, (index,), value + by)
        else:
            put_element(p, (index,), value + by)
        put_element(answers, (side, row), plant_force(code, x + by_x, v + by_v, z, t, p, mode))
        if states:
            plant_rate(code, x + by_x, v + by_v, z, t, p, mode, answers[side, own : own + states])
    if what == OF_STATE:
        put_element(y, (index,), value)
    elif what == OF_PARAMETER:
        put_element(p, (index,), value)
    half = 0.5 / step
    for i in range(states + 1):
        force = row if i == 0 else own + i - 1
        slope = half * (element(answers, (0, force)) - element(answers, (1, force)))
        if what == OF_PARAMETER:
            _add(beside, force, slope, change, (row, index), groups)
        else:
            put_element(found, (force, column), element(found, (force, column)) + slope)


@inlined
def _by_drive(wires, tangents, places, found, beside, wire, moves, force, slope, y, groups):  # type: ignore[no-untyped-def]
    """What a force changes by where its wire is driven, and where parameters have it `moves`, by these."""
    for j in range(places.size):
        place = element(places, (j,))
        change = slope * element(wires.drive, (wire, place))
        put_element(found, (force, j), element(found, (force, j)) + change)
        if moves:
            _add(beside, force, slope * element(y, (place,)), tangents.drive, (wire, place), groups)


@inlined
def _wire(nonlinear, tangents, ask, found, beside, e, y, groups):  # type: ignore[no-untyped-def]
    """What changes by one of the things that wires are asked about."""
    wires, n, p = nonlinear.wires, nonlinear.n, ask.wire_parameters
    wire, what = element(ask.wires, (e, 0)), element(ask.wires, (e, 1))
    row, index = element(ask.wires, (e, 2)), element(ask.wires, (e, 3))
    dof, k = element(wires.dof, (wire,)), element(wires.stiffness, (wire,))
    u, x, v = drive_side(wires, wire, y), element(y, (dof,)), element(y, (dof + n,))
    force = found.shape[0] - wires.dof.size + wire
    longest = ask.elongation[wire] = max(ask.elongation[wire], abs(u - x))
    step, value = WIRE_STEP * _size(u - x, longest), 0.0
    if what == BY_SPEED:
        step = TANGENT_STEP * _size(v, element(ask.seen, (dof + n,)))
    elif what == BY_STIFFNESS:
        step = TANGENT_STEP * k
    elif what == BY_PARAMETER:
        value = p[row, index]
        step = TANGENT_STEP * (abs(value) if value != 0.0 else 1.0)
    slope = 0.0
    for side in range(2):
        by = step if side == 0 else -step
        if what == BY_PARAMETER:
            p[row, index] = value + by
        answer = wire_force(
            wires, wire, u + by if what == AT_DRIVE else u, x + by if what == AT_DOF else x,
            v + by if what == BY_SPEED else v, k + by if what == BY_STIFFNESS else k, p,
        )  # fmt: skip
        slope += answer if side == 0 else -answer
    slope *= 0.5 / step
    if what == AT_DRIVE:
        _by_drive(wires, tangents, ask.places, found, beside, wire, row, force, slope, y, groups)
    elif what == BY_STIFFNESS:
        _add(beside, force, slope, tangents.stiffness, (wire,), groups)
    elif what == BY_PARAMETER:
        p[row, index] = value
        _add(beside, force, slope, tangents.wire_parameters, (row, index), groups)
    else:
        found[force, ask.ends[wire, what - AT_DOF]] += slope


@whole
def find_slopes(nonlinear, tangents, ask, y, t, modes, groups):  # type: ignore[no-untyped-def]
    """How forces change at y = [y, held] and time `t` (s), into ``ask.slopes`` and ``ask.beside``."""
    nonlinear, tangents, ask = lent(given(nonlinear)), lent(given(tangents)), lent(given(ask))
    found, beside, places, seen, partitions = (
        ask.slopes,
        ask.beside,
        ask.places,
        ask.seen,
        nonlinear.laws.numbers,
    )
    for force in range(found.shape[0]):
        for j in range(places.size):
            found[force, j] = 0.0
        for group in range(len(groups)):
            put_numbers(beside, (force, group), everywhere(0.0))
    for j in range(places.size):
        place = element(places, (j,))
        put_element(seen, (place,), max(element(seen, (place,)), abs(element(y, (place,)))))
    for e in range(ask.laws.shape[0]):
        row = element(ask.laws, (e, 0))
        mode = element(modes, (row,))
        if element(partitions, (row, PARTITION)) != FRICTION or mode != 0:
            _law(nonlinear, tangents.parameters, ask, found, beside, e, y, t, mode, groups)
    for e in range(ask.wires.shape[0]):
        _wire(nonlinear, tangents, ask, found, beside, e, y, groups)
