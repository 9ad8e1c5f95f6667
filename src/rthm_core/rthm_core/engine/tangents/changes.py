"""How a loop changes with parameters of its spec: derivatives of its matrices, held forces and start.

The matrices are smooth in every parameter, so that differences of them are as good as formulas, and no
formula of the physics is written a second time. The last two axes of every array are the parameters, in
groups of `WIDTH`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rthm_core.compiled import Flags, Floats, Integers
from rthm_core.engine.nonlinear.loop import Nonlinear, NonlinearLoop, nonlinear_loop
from rthm_core.errors import InputError
from rthm_core.kept import kept
from rthm_core.physical.laws import CODE, FRICTION, PARTITION, law_of
from rthm_core.simd import WIDTH, simd_copy
from rthm_core.spec import apply, number_at

if TYPE_CHECKING:
    from rthm_core.spec import Spec

TANGENT_STEP = 1e-5
"""Step of the differences, relative to the parameter; absolute where that is zero."""

Stencil = list[tuple["Spec", float]]
"""Specs beside the given one, and the weight of each in the derivative."""


class Tangents(NamedTuple):
    """Derivatives with respect to parameters, of what `Nonlinear`, `Looks` and `NonlinearLoop` hold.

    The last two axes, Q groups of 8 lanes, are the parameters (`Placement`); one lane is the motion itself.
    There matrices and limits are zero, since these do not change, and all else is as it is.

    Attributes
    ----------
    systems, holds : (S, N, d, Q, 8), (S, L, d, Q, 8) arrays
    forces : (L, 3, Q, 8) array
        Force of each law in its modes -1, 0 and 1; zero where any depends on the motion.
    breakaway, thresholds : (L, Q, 8), (L, 2, Q, 8) arrays
    parameters : (L, 8, Q, 8) array
    drive, stiffness, wire_parameters : (W, N + M, Q, 8), (W, Q, 8), (R, 8, Q, 8) arrays
        Of `Wires`.
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
    thresholds: Floats
    parameters: Floats
    drive: Floats
    stiffness: Floats
    wire_parameters: Floats
    sample: Floats
    force: Floats
    reference: Floats
    bias: Floats
    k_tot: Floats
    start: Floats
    first_sample: Floats
    first_reference: Floats


class Placement(NamedTuple):
    """Where parameters are: those that change the same rows of a step are in the same groups of lanes.

    Attributes
    ----------
    order, lanes : (P,) arrays
        Parameters as they follow each other, and the lane of each of these.
    places : (P,) array
        Place of each parameter among them.
    before : tuple of int
        How many parameters come before each group.
    motion : int
        Lane of the motion, behind the last parameter's.
    """

    order: Integers
    lanes: Integers
    places: Integers
    before: tuple[int, ...]
    motion: int


@kept
def stencil(spec: Spec, name: str) -> Stencil:
    """Second-order difference with respect to a parameter: central, or forward from a lower bound. Its specs
    are kept, and with them what simulations of them need.

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


def tangents(spec: Spec, loop: NonlinearLoop, names: Sequence[str]) -> tuple[Tangents, Placement] | None:
    """Derivatives of a loop, and where they are; None where a small change of a parameter changes what the
    loop is made of.
    """
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
    placement, motion = _placement(loop, [of_one[0] for of_one in derivatives]), _motion(loop)
    placed = zip(*derivatives, motion, strict=True)
    return Tangents(*(_lanes(parts, own, placement) for *parts, own in placed)), placement


def reach(systems: Floats) -> Flags:
    """Which states (N, N) each state depends on after some time, by the sizes (N, d) of what moves it."""
    n = systems.shape[0]
    reached = np.eye(n, dtype=bool)
    for _ in range(n):
        reached = reached | (reached.astype(int) @ (systems[:, :n] != 0.0) > 0)
    return reached


def _placement(loop: NonlinearLoop, systems: Sequence[Floats]) -> Placement:
    """Places of parameters that change the `systems` (S, N, d) so; none needs more groups than they fill."""
    sizes = [np.abs(one).sum(axis=0) for one in systems]
    reached = reach(np.abs(loop.nonlinear.systems).sum(axis=0) + np.sum(sizes, axis=0))
    moved = [tuple(np.flatnonzero(reached.astype(int) @ one.any(axis=1))) for one in sizes]
    order = sorted(range(len(moved)), key=lambda p: moved[p])
    room, lanes, lane = (len(order) // WIDTH + 1) * WIDTH, [], 0
    for place, p in enumerate(order):
        apart = place > 0 and moved[order[place - 1]] not in ((), moved[p])
        following = -(-lane // WIDTH) * WIDTH
        if apart and following + len(order) - place < room:
            lane = following
        lanes.append(lane)
        lane += 1
    before = np.searchsorted(lanes, np.arange(0, room, WIDTH))
    return Placement(np.array(order), np.array(lanes), np.argsort(order), tuple(before.tolist()), lane)


def _motion(loop: NonlinearLoop) -> list[Floats]:
    """Lane of the motion, in the order of `Tangents`."""
    themselves = ("forces", "bias", "start", "first_sample", "first_reference")
    arrays = zip(Tangents._fields, _arrays(loop), strict=True)
    return [one if name in themselves else np.zeros_like(one) for name, one in arrays]


def _lanes(derivatives: Sequence[Floats], motion: Floats, placement: Placement) -> Floats:
    """Arrays along a last axis of lanes, parted into groups."""
    groups = len(placement.before)
    lanes = np.zeros((*motion.shape, groups * WIDTH))
    for p, lane in zip(placement.order, placement.lanes, strict=True):
        lanes[..., lane] = derivatives[p]
    lanes[..., placement.motion] = motion
    return simd_copy(lanes.reshape(*motion.shape, groups, WIDTH))


def _arrays(loop: NonlinearLoop) -> tuple[Floats, ...]:
    """What of a loop depends on parameters, in the order of `Tangents`."""
    nonlinear, linear = loop.nonlinear, loop.linear
    return (
        nonlinear.systems,
        nonlinear.holds,
        _forces(nonlinear),
        nonlinear.laws.breakaway,
        np.nan_to_num(nonlinear.laws.thresholds, posinf=0.0, neginf=0.0),
        nonlinear.laws.parameters,
        nonlinear.wires.drive,
        nonlinear.wires.stiffness,
        nonlinear.wires.parameters,
        loop.sample.T,
        loop.force.T,
        loop.reference.T,
        linear.bias,
        linear.k_tot,
        loop.start,
        linear.first_sample,
        linear.first_reference,
    )


def _forces(nonlinear: Nonlinear) -> Floats:
    """Force (L, 3) in the modes -1, 0 and 1 of laws that are constant in each; zero where any is not."""
    numbers, parameters = nonlinear.laws.numbers, nonlinear.laws.parameters
    found = np.zeros((numbers.shape[0], 3))
    for row, (law, p) in enumerate(zip(numbers, parameters, strict=True) if nonlinear.steady else ()):
        of_mode: Any = law_of(law[CODE]).force
        for mode in (-1, 1):
            found[row, mode + 1] = of_mode(0.0, 0.0, [], 0.0, p, mode)
        assert law[PARTITION] == FRICTION
    return found
