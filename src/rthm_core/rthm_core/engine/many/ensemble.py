"""Many loops that differ in their numbers, simulated side by side."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rthm_core.clock import to_ns
from rthm_core.compiled import Floats, Integers
from rthm_core.engine.linear.vectors import vector
from rthm_core.engine.many.delayed import Clocks, Loops, memories, moving, run_each
from rthm_core.engine.many.lanes import Lanes, room, run_lanes
from rthm_core.engine.many.numbered import Numbered, in_memory, numbered
from rthm_core.engine.many.period import notes
from rthm_core.engine.simulate import simulate
from rthm_core.errors import InputError
from rthm_core.simd import WIDTH, simd_copy
from rthm_core.substructure import held_dynamics, interface

if TYPE_CHECKING:
    from rthm_core.spec import Spec

SIDE = ("mass", "damping", "stiffness", "initial_position", "initial_velocity")
VARIED = (
    *(f"{side}.{key}" for side in ("plant", "numerical") for key in SIDE),
    "interface.stiffness",
    "interface.damping",
    "actuator.stiffness",
)
"""What may differ between loops that run side by side."""

TIMES = tuple(f"timing.{name}" for name in Clocks._fields)
"""What may differ, too, between loops that run one after the other in one kernel; anything else has each
prepared by itself."""


@dataclass(frozen=True)
class Ensemble:
    """Motion of L loops at the instants `t` (s, N of them); SI units.

    Attributes
    ----------
    plant_position, plant_velocity, numerical_position, numerical_velocity : (L, N, n) arrays
    force_reference, actuator_force : (L, N, m) arrays
        F_d in use by the controller, and the force in the wire.
    """

    t: Floats
    plant_position: Floats
    plant_velocity: Floats
    numerical_position: Floats
    numerical_velocity: Floats
    force_reference: Floats
    actuator_force: Floats


def simulate_many(
    spec: Spec, changes: Mapping[str, npt.ArrayLike], duration: float, sample: float | None = None
) -> Ensemble:
    """Simulate many loops exactly.

    Parameters
    ----------
    spec : Spec
        What all loops have in common.
    changes : mapping of str to array
        Entries of the spec as `spec.apply` takes them; the first axis of each is the loop.
    duration : float
        Length in s.
    sample : float, optional
        Distance of the rows in s; Td1 when absent.

    Raises
    ------
    InputError
        When the entries do not have the same number of loops, or one of the loops is not allowed.
    """
    arrays = {key: np.asarray(values, dtype=float) for key, values in changes.items()}
    sizes = {values.shape[0] if values.ndim else 0 for values in arrays.values()}
    if len(sizes) != 1 or 0 in sizes:
        raise InputError(
            "changes must have the same number of loops, above zero, along the first axis of every entry; "
            f"here they have {sorted(sizes)}."
        )
    count = sizes.pop()
    step = to_ns(spec.loop().timing.td1 if sample is None else sample)
    plain = _is_plain(spec) and set(arrays) <= {*VARIED, *TIMES}
    program = numbered(spec, step) if plain and set(arrays) <= set(VARIED) else None
    if plain:
        _check(spec, arrays)
    if program is not None:
        return _side_by_side(spec, arrays, count, to_ns(duration), step, program)
    clocks = _clocks(spec, arrays, count)
    if plain and spec.loop().timing.td4 == 0.0 and clocks[:, -1].min() > 0:
        return _each_with_its_delays(spec, arrays, count, to_ns(duration), step, clocks)
    return _one_after_the_other(spec, arrays, count, duration, step)


def _is_plain(spec: Spec) -> bool:
    """Whether there is nothing in the loop but masses, springs, dampers and stiff motors."""
    loop, noise = spec.loop(), spec.noise
    loaded = any(one is not None and one.kind != "none" for one in (spec.load.plant, spec.load.numerical))
    motors = loop.actuator.motor_poles or loop.actuator.transmission or any(loop.actuator.pretension or ())
    noisy = any((noise.position, noise.velocity))
    return not (spec.effects or loaded or motors or noisy) and str(loop.actuator.compensator) == "none"


def _one_after_the_other(
    spec: Spec, arrays: dict[str, Floats], count: int, duration: float, step: int
) -> Ensemble:
    from rthm_core.spec import apply

    def one(i: int) -> Any:
        own = {key: values[i].tolist() for key, values in arrays.items()}
        return simulate(apply(spec, own), duration, step * 1e-9, energies=False)

    found = [one(i) for i in range(count)]
    names = [name for name in Ensemble.__dataclass_fields__ if name != "t"]
    return Ensemble(found[0].t, **{name: np.stack([getattr(one, name) for one in found]) for name in names})


def _check(spec: Spec, arrays: dict[str, Floats]) -> None:
    """Refuse what `apply` refuses.

    Looked at are the least and the largest number of every entry, and the mass that is nearest to not being
    positive definite: all of a kind in one spec, and only if that is refused those loops that have them.
    """
    from rthm_core.spec import apply

    suspects = {key: _suspects(key, values) for key, values in arrays.items()}
    try:
        for which in range(max(map(len, suspects.values()))):
            apply(spec, {key: _of_loop(key, arrays, own[which % len(own)]) for key, own in suspects.items()})
    except InputError:
        for key, own in suspects.items():
            for loop in own:
                apply(spec, {key: _of_loop(key, arrays, loop)})


def _suspects(key: str, values: Floats) -> list[int]:
    """Loops whose numbers are at an end of what there is."""
    flat = values.reshape(values.shape[0], -1)
    suspects = [int(flat.min(axis=1).argmin()), int(flat.max(axis=1).argmax())]
    if key.endswith(".mass") and flat.shape[1] > 1:
        size = round(flat.shape[1] ** 0.5)
        suspects.append(int(np.linalg.eigvalsh(flat.reshape(-1, size, size)).min(axis=1).argmin()))
    return suspects


def _of_loop(key: str, arrays: dict[str, Floats], loop: int) -> float | list[float]:
    """Numbers of an entry for one loop."""
    flat = arrays[key][loop].reshape(-1)
    return float(flat[0]) if key in TIMES else flat.tolist()


def _entry(spec: Spec, arrays: dict[str, Floats], key: str, *shape: int) -> Floats:
    """Entry of every loop, (L, *shape)."""
    section, name = key.split(".")
    count = next(iter(arrays.values())).shape[0]
    given = arrays.get(key, np.array([getattr(getattr(spec, section), name)], dtype=float))
    return np.array(np.broadcast_to(given.reshape(given.shape[0], *shape), (count, *shape)))


def _side_by_side(
    spec: Spec, arrays: dict[str, Floats], count: int, end: int, step: int, program: Numbered
) -> Ensemble:
    stacked, dofs = _stacked(spec, arrays, count), interface(spec)[:2]
    m, rows = len(dofs[0]), end // step + 1
    n1, n2 = stacked.y1.shape[0] - m, stacked.y2.shape[0] - 2 * m
    found = np.empty((count, rows, n1 + n2 + 2 * m))
    like = tuple(vector(np.zeros(size)) for size in (n1, n1 + m, n2, n2 + 2 * m, m))
    shapes = (program.lengths[0].size, n1 + m, n1), (program.lengths[1].size, n2 + 2 * m, n2)
    own, passes = room(shapes, *program.sizes, m), end // program.period + 1
    operations, moving = in_memory(program, own, m), stacked._replace(a1=stacked.a1[:n1], a2=stacked.a2[:n2])
    run_lanes(_in_groups(moving, count), dofs, program.lengths, operations, passes, found, like, own)
    return _ensemble(found, step, n1, n2, m)


def _ensemble(found: Floats, step: int, n1: int, n2: int, m: int) -> Ensemble:
    """Rows (L, N, n1 + n2 + 2 m) that a kernel filled, one every `step` ns, by signal."""
    ends = np.cumsum([n1 // 2, n1 // 2, n2 // 2, n2 // 2, m])
    return Ensemble(np.arange(found.shape[1], dtype=float) * (step * 1e-9), *np.split(found, ends, axis=2))


def _clocks(spec: Spec, arrays: dict[str, Floats], count: int) -> Integers:
    """Periods and delays (L, 7) in ns."""
    seconds = [_entry(spec, arrays, key).reshape(-1) for key in TIMES]
    return np.rint(np.stack([np.broadcast_to(one, count) for one in seconds], axis=1) * 1e9).astype(np.int64)


def _each_with_its_delays(
    spec: Spec, arrays: dict[str, Floats], count: int, end: int, step: int, clocks: Integers
) -> Ensemble:
    stacked = _stacked(spec, arrays, count)
    dofs = interface(spec)[:2]
    m, rows = len(dofs[0]), end // step + 1
    n1, n2 = stacked.y1.shape[0] - m, stacked.y2.shape[0] - 2 * m
    found = np.empty((count, rows, n1 + n2 + 2 * m))
    dynamics = (stacked.a1[:n1, :n1], stacked.a2[:n2, :n2])
    modes = [np.linalg.eigvals(np.moveaxis(a, 2, 0)) for a in dynamics]
    fastest = np.stack([np.abs(own).max(axis=1) for own in modes], axis=1)
    a1, a2, y1, y2, k_tot, _, stiffness, damping = (
        np.ascontiguousarray(np.moveaxis(part, -1, 0)) for part in stacked
    )
    like = tuple(vector(np.zeros(size)) for size in (n1, m, n2, 2 * m))
    loops = Loops(a1, a2, y1, y2, k_tot, stiffness, damping, fastest, clocks)
    sides = (moving(n1, m), moving(n2, 2 * m))
    run_each(loops, dofs, sides, memories(clocks, m), notes(), like, step, found)
    return _ensemble(found, step, n1, n2, m)


def _in_groups(stacked: Lanes, count: int) -> Lanes:
    """The loops in groups of as many as run side by side; the last is repeated where there are too few."""
    chosen: Integers = np.minimum(np.arange(-(-count // WIDTH) * WIDTH), count - 1)

    def grouped(part: Floats) -> Floats:
        groups = simd_copy(np.moveaxis(part[..., chosen].reshape(*part.shape[:-1], -1, WIDTH), -2, 0))
        return groups if groups.ndim == 4 else groups.reshape(groups.shape[0], -1)

    return Lanes(*map(grouped, stacked))


def _stacked(spec: Spec, arrays: dict[str, Floats], count: int) -> Lanes:
    """Dynamics and start of all loops; the last axis is the loop."""
    sides, m = interface(spec), len(spec.k_tot)
    n1, n2 = len(spec.plant.dofs), len(spec.loop().numerical.dofs)
    k_tot = _entry(spec, arrays, "actuator.stiffness", m)
    k, c = (_entry(spec, arrays, f"interface.{name}", m) for name in ("stiffness", "damping"))
    none = np.zeros((count, m))
    x1, v1, dynamics1, push1 = _body(spec, arrays, "plant", n1, sides.plant, k_tot, none)
    x2, v2, dynamics2, push2 = _body(spec, arrays, "numerical", n2, sides.numerical, k, c)
    a1 = _driven(count, dynamics1, push1 * k_tot[:, None, :])
    a2 = _driven(count, dynamics2, np.concatenate([push2 * k[:, None, :], push2 * c[:, None, :]], axis=2))
    at = [x1[:, sides.plant], v1[:, sides.plant], x2[:, sides.numerical], v2[:, sides.numerical]]
    command = at[0] + (-c * (at[1] - at[3]) - k * (at[0] - at[2])) / k_tot

    def last(*parts: Floats) -> Floats:
        return np.ascontiguousarray(np.concatenate(parts, axis=1).T)

    return Lanes(
        a1,
        a2,
        last(x1, v1, command),
        last(x2, v2, at[0], at[1]),
        last(k_tot),
        last(1.0 / k_tot),
        last(k),
        last(c),
    )


def _body(
    spec: Spec, arrays: dict[str, Floats], side: str, n: int, dofs: Integers, k: Floats, c: Floats
) -> tuple[Floats, Floats, Floats, Floats]:
    """Initial motion, dynamics, and effect of unit forces at the interface, of one side of every loop."""
    mass, damping, stiffness = (_entry(spec, arrays, f"{side}.{name}", n, n) for name in SIDE[:3])
    x, v = (_entry(spec, arrays, f"{side}.{name}", n) for name in SIDE[3:])
    dynamics, inverse = held_dynamics(mass, damping, stiffness, dofs, k, c)
    return x, v, dynamics, inverse[..., dofs]


def _driven(count: int, dynamics: Floats, input_matrix: Floats) -> Floats:
    """Dynamics of [state, held inputs], the loop last."""
    size, held = dynamics.shape[1], input_matrix.shape[2]
    a = np.zeros((count, size + held, size + held))
    a[:, :size, :size], a[:, size // 2 : size, size:] = dynamics, input_matrix
    return np.ascontiguousarray(np.moveaxis(a, 0, 2))
