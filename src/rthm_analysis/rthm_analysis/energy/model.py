"""The model whose energy balance is computed: the loop of the spec, or its plant alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.energy.kernel import Balance
from rthm_analysis.energy.series import Series
from rthm_core.clock import NS
from rthm_core.compensation import first_parts as command_parts
from rthm_core.compiled import Floats, Integers
from rthm_core.energy import delay_matrices
from rthm_core.engine.general.ledger import Ledger, ledger
from rthm_core.linear import linear_system
from rthm_core.loads import NO_LOAD, load, together
from rthm_core.numerical import Numerical, NumericalSide, numerical
from rthm_core.physical.model import physical_model
from rthm_core.physical.start import physical
from rthm_core.substructure import as_built, interface

if TYPE_CHECKING:
    from rthm_core.spec import Spec


def plant_alone(spec: Spec) -> Spec:
    """Spec of the plant without the rest of the loop."""
    rest = ("numerical", "interface", "actuator", "timing", "limits")
    effects = tuple(effect for effect in spec.effects if effect.block == "plant")
    return spec.model_copy(update=dict.fromkeys(rest) | {"effects": effects})


def open_balance(
    spec: Spec, begin_ns: int, z1: Floats, z2: Floats, held: Floats, first_fx: Floats, first_ff: Floats
) -> Balance:
    """Energy balance of a loop, or of a plant alone, at the instant `begin_ns` after the start of the test.

    Parameters
    ----------
    z1, z2 : (2 n1,), (2 n2,) arrays
        Motion of both substructures; `z2` is empty for a plant alone.
    held : (2 m,) array
        [x1, v1] that the numerical side holds.
    first_fx, first_ff : (m,) arrays
        Both parts of the command in steady state, in m.
    """
    n1 = len(spec.plant.dofs)
    measured = [(NO_LOAD, dof) for dof in range(n1)]
    model, resting = physical_model(spec, further=measured)
    one = physical(model, resting, z1[:n1], z1[n1:], first_fx + first_ff)
    two = numerical(as_built(spec, "numerical")) if spec.is_loop else _nothing()
    one.state.time[0] = two.time[0] = begin_ns
    if spec.is_loop:
        two.y[:], two.held[:] = z2, held
    counted = ledger(spec, one, two, first_fx, first_ff, on=True)
    quiet = max(4.0 * spec.noise.velocity, 1e-12)
    return Balance(
        one,
        two,
        counted if spec.is_loop else _with_nothing(counted),
        int(model.listed_loads) - n1,
        quiet,
    )


def _nothing() -> Numerical:
    """Numerical side of a plant alone: a unit mass at rest that nothing is connected to."""
    none, no_index = np.empty(0), np.empty(0, dtype=np.int64)
    system = linear_system(np.zeros((2, 2)), np.zeros((2, 1)))
    at_rest, first = np.zeros(2), np.zeros(1, dtype=np.int64)
    return Numerical(
        1,
        0,
        system,
        together([NO_LOAD]),
        first,
        no_index,
        none,
        none,
        first.copy(),
        at_rest,
        none,
        np.zeros((1, 1)),
    )


def _with_nothing(counted: Ledger) -> Ledger:
    nothing = np.zeros((1, 1))
    return counted._replace(bodies=counted.bodies._replace(m2=nothing, c2=nothing.copy(), k2=nothing.copy()))


def load_at(spec: Spec, times_ns: Integers) -> Floats:
    """Load that the spec knows on every plant dof, in N, shape (times, n1)."""
    section = spec.load.plant
    forces = np.zeros((times_ns.size, len(spec.plant.dofs)))
    if section is not None and section.kind != "none":
        forces[:, spec.plant.dofs.index(section.dof)] = load(section).force(times_ns / NS)
    return forces


def estimated_power(spec: Spec, velocity: Floats, acceleration: Floats) -> Floats:
    """Power of the errors that delays and holds bring in, in W, by the corrected (27).

    ``-(M_tau a) . v - (C_tau v) . v`` with the delay-dependent parts of (26a) and (26b).

    Parameters
    ----------
    velocity, acceleration : (n, n1 + n2) arrays
        Plant dofs first.
    """
    mass, damping = delay_matrices(spec)
    power = np.einsum("ti,ij,tj->t", velocity, mass, acceleration)
    return np.asarray(-power - np.einsum("ti,ij,tj->t", velocity, damping, velocity))


def first_parts(spec: Spec) -> tuple[Floats, Floats, Floats, Floats]:
    """State z2, held motion, and both parts of the command, in steady state before a test."""
    loop, sides = spec.loop(), interface(spec)
    x1 = np.array(loop.plant.initial_position, dtype=float)[sides.plant]
    v1 = np.array(loop.plant.initial_velocity, dtype=float)[sides.plant]
    z2 = np.array([*loop.numerical.initial_position, *loop.numerical.initial_velocity], dtype=float)
    return z2, np.concatenate([x1, v1]), *command_parts(spec)


def begins(spec: Spec, start_ns: int, ticks: Series) -> bool:
    """Whether the samples reach back to the start: the numerical side is still where the spec put it."""
    z2 = first_parts(spec)[0]
    at_start = ticks.stamps.size > 0 and ticks.stamps[0] <= start_ns
    return bool(at_start and np.allclose(ticks.rows[0], z2, rtol=1e-9, atol=1e-12))


def state_at(spec: Spec, since_ns: int, z2: Floats, held: Floats, until_ns: int) -> Floats:
    """State of the numerical side at `until_ns`, from the state and the held motion at `since_ns`."""
    side = NumericalSide(spec)
    side.compiled.time[0], side.compiled.y[:] = since_ns, z2
    side.latch(held[: held.size // 2], held[held.size // 2 :])
    side.advance(until_ns)
    return np.concatenate([side.position, side.velocity])
