"""The numerical substructure: a linear structure that sees the plant's motion held between its ticks.

``M2 a2 = -c3 v2 - k3 x2 - F_c(z1 held, z2 continuous) + w2`` (contract, section 1; paper, (9b) with the
corrected (10b)).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, called, compiled_in_place
from rthm_core.errors import InputError
from rthm_core.kept import kept_without_timing
from rthm_core.lent import lent
from rthm_core.linear import LinearSystem, linear_system, step_linear
from rthm_core.loads import Loads, load, load_derivatives, smooth_until, together
from rthm_core.substructure import as_built, held_dynamics, interface, substructure

if TYPE_CHECKING:
    from rthm_core.spec import Spec


class Numerical(NamedTuple):
    """Numerical side for compiled code.

    The inputs of `system` are [held x1 (m), held v1 (m), loads]; its state is [x2, v2].
    """

    n: int
    m: int
    system: LinearSystem
    loads: Loads
    load_dof: Integers
    dof: Integers
    stiffness: Floats
    damping: Floats
    time: Integers
    y: Floats
    held: Floats
    inputs: Floats


def numerical(spec: Spec) -> Numerical:
    """Numerical side of a spec at the start of a test.

    Raises
    ------
    InputError
        When the spec describes no loop.
    """
    if spec.numerical is None or spec.plant is None:
        raise InputError(
            "numerical is missing: a hybrid test needs a numerical substructure; add the "
            "section or use a spec that has it."
        )
    body, sides = substructure(spec.numerical), interface(spec)
    n, m = body.dofs, sides.actuators
    a, inverse_mass = held_dynamics(
        body.mass, body.damping, body.stiffness, sides.numerical, sides.stiffness, sides.damping
    )
    section = spec.load.numerical
    one = load(section)
    load_dof = spec.numerical.dofs.index(section.dof) if section is not None and section.dof else 0
    b = np.zeros((2 * n, 2 * m + 1))
    b[n:, :m] = inverse_mass[:, sides.numerical] * sides.stiffness
    b[n:, m : 2 * m] = inverse_mass[:, sides.numerical] * sides.damping
    b[n:, 2 * m] = inverse_mass[:, load_dof]
    x1, v1 = np.array(spec.plant.initial_position), np.array(spec.plant.initial_velocity)
    orders = one.orders
    return Numerical(
        n,
        m,
        linear_system(a, b, orders),
        together([one]),
        np.array([load_dof], dtype=np.int64),
        sides.numerical,
        sides.stiffness,
        sides.damping,
        np.zeros(1, dtype=np.int64),
        np.concatenate([body.position, body.velocity]),
        np.concatenate([x1[sides.plant], v1[sides.plant]]).astype(float),
        np.zeros((orders, 2 * m + 1)),
    )


@kept_without_timing
def shared_numerical(spec: Spec) -> Numerical:
    """Numerical side with what it really computes with, made once for all that only read it."""
    return numerical(as_built(spec, "numerical"))


@called
def begin_numerical(numerical):  # type: ignore[no-untyped-def]
    """Write held motion and load derivatives at the present instant into ``numerical.inputs``."""
    for i in range(2 * numerical.m):
        numerical.inputs[0, i] = numerical.held[i]
    load_derivatives(numerical.loads, numerical.time[0], 2 * numerical.m, numerical.inputs)


@called
def advance_numerical(numerical, to_ns):  # type: ignore[no-untyped-def]
    """Advance to an instant (ns since the start)."""
    while numerical.time[0] < to_ns:
        now = numerical.time[0]
        end = smooth_until(numerical.loads, now, to_ns)
        begin_numerical(numerical)
        step_linear(numerical.system, numerical.y, numerical.inputs, (end - now) * 1e-9)
        numerical.time[0] = end


@called
def interface_force(numerical, motion, out):  # type: ignore[no-untyped-def]
    """F_c (m,) between a motion [x1 (m), v1 (m)] of the plant and the present numerical state."""
    m = numerical.m
    for i in range(m):
        dof = numerical.dof[i]
        x2, v2 = numerical.y[dof], numerical.y[numerical.n + dof]
        out[i] = -numerical.damping[i] * (motion[m + i] - v2) - numerical.stiffness[i] * (motion[i] - x2)


@compiled_in_place
def _advance(numerical: Numerical, to_ns: int) -> None:
    advance_numerical(lent(numerical), to_ns)


@compiled_in_place
def _force(numerical: Numerical, out: Floats) -> None:
    interface_force(lent(numerical), numerical.held, out)


class NumericalSide:
    """The numerical substructure as an object: what the numerical node and the tests hold.

    All instants are ns since the start of the test. At a tick: `advance`, `latch`, `force_reference`.

    Raises
    ------
    InputError
        When the spec describes no loop.
    """

    def __init__(self, spec: Spec) -> None:
        self.compiled = numerical(as_built(spec, "numerical"))

    def latch(self, position: Floats, velocity: Floats) -> None:
        """Hold the plant's motion (m,) at the interface dofs from now on."""
        m = self.compiled.m
        self.compiled.held[:m], self.compiled.held[m:] = position, velocity

    def advance(self, to_ns: int) -> None:
        """Advance to an instant; an earlier one changes nothing."""
        _advance(self.compiled, to_ns)

    def force_reference(self) -> Floats:
        """F_d (m,), in N, of the held motion and the present numerical state."""
        out = np.empty(self.compiled.m)
        _force(self.compiled, out)
        return out

    @property
    def position(self) -> Floats:
        """x2 (n,), in m."""
        return self.compiled.y[: self.compiled.n]

    @property
    def velocity(self) -> Floats:
        """v2 (n,), in m/s."""
        return self.compiled.y[self.compiled.n :]

    @property
    def load(self) -> Floats:
        """w2 (n,), in N, now."""
        _loads_now(self.compiled)
        loads = np.zeros(self.compiled.n)
        loads[self.compiled.load_dof[0]] = self.compiled.inputs[0, 2 * self.compiled.m]
        return loads


@compiled_in_place
def _loads_now(numerical: Numerical) -> None:
    begin_numerical(lent(numerical))
