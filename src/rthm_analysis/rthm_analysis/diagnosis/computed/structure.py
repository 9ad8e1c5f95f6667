"""The numerical substructure as the replay needs it: matrices, exact step, and parameters by name.

``M2 a2 = -c3 v2 - k3 x2 - F_c(z1 held, z2) + w2`` with ``F_c = -c2 (v1 - v2) - k2 (x1 - x2)``. Between two
ticks z1 is held and the load w2 is a cubic, so a step is a matrix.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.clock import NS
from rthm_core.exponential import exponentials
from rthm_core.spec.sections import MATRICES
from rthm_core.substructure import as_built, held_dynamics, interface, substructure

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec import Spec

LOAD_COEFFICIENTS = 4
"""Coefficients of the load between two ticks."""


class Step(NamedTuple):
    """``z2(next) = state z2 + held z1 + sum over k of load[k] (k-th derivative of w2)``.

    `state` is (2 n, 2 n), `held` (2 n, 2 m) and `load` (LOAD_COEFFICIENTS, 2 n, n).
    """

    state: Floats
    held: Floats
    load: Floats


@dataclass(frozen=True)
class Structure:
    """Numerical substructure with its side of the interface.

    Attributes
    ----------
    mass, damping, stiffness : (n, n) arrays
        kg, N s/m, N/m.
    interface_stiffness, interface_damping : (m,) arrays
        N/m, N s/m.
    dof : (m,) array
        Numerical dof that each actuator stands for.
    """

    mass: Floats
    damping: Floats
    stiffness: Floats
    interface_stiffness: Floats
    interface_damping: Floats
    dof: Integers

    @property
    def names(self) -> list[tuple[str, int]]:
        """Every parameter, as field and index; zeros off the diagonal are taken as no parameters."""
        found = []
        for field in fields(self)[:-1]:
            values = getattr(self, field.name)
            diagonal = (
                np.eye(values.shape[0], dtype=bool).ravel() if values.ndim == 2 else np.ones(values.size)
            )
            found += [
                (field.name, i) for i in range(values.size) if values.ravel()[i] != 0.0 or diagonal.ravel()[i]
            ]
        return found

    def value(self, name: tuple[str, int]) -> float:
        """Value of one parameter."""
        return float(getattr(self, name[0]).ravel()[name[1]])

    def changed(self, name: tuple[str, int], value: float) -> Structure:
        """Return the structure with another value of one parameter."""
        values = getattr(self, name[0]).copy()
        values.ravel()[name[1]] = value
        return replace(self, **{name[0]: values})

    def spec_name(self, name: tuple[str, int]) -> str:
        """Name of a parameter in the spec, with its index where there are several."""
        section = "interface" if name[0].startswith("interface") else "numerical"
        entry = f"{section}.{name[0].removeprefix('interface_')}"
        return entry if getattr(self, name[0]).size == 1 else f"{entry}[{name[1]}]"

    def unit(self, name: tuple[str, int]) -> str:
        """Unit of a parameter."""
        return MATRICES[name[0].removeprefix("interface_")]

    def force(self, held: Floats, z2: Floats) -> Floats:
        """F_d (k, m) of held motion (k, 2 m) and numerical state (k, 2 n), N."""
        m, n = self.dof.size, self.mass.shape[0]
        x2, v2 = z2[:, self.dof], z2[:, n + self.dof]
        return -self.interface_damping * (held[:, m:] - v2) - self.interface_stiffness * (held[:, :m] - x2)

    def step(self, dt: float) -> Step:
        """Exact step of `dt` seconds."""
        n, m = self.mass.shape[0], self.dof.size
        a, inverse = held_dynamics(
            self.mass,
            self.damping,
            self.stiffness,
            self.dof,
            self.interface_stiffness,
            self.interface_damping,
        )
        whole = np.zeros((2 * n + 2 * m + LOAD_COEFFICIENTS * n,) * 2)
        whole[: 2 * n, : 2 * n] = a
        whole[n : 2 * n, 2 * n : 2 * n + m] = inverse[:, self.dof] * self.interface_stiffness
        whole[n : 2 * n, 2 * n + m : 2 * n + 2 * m] = inverse[:, self.dof] * self.interface_damping
        first = 2 * n + 2 * m
        whole[n : 2 * n, first : first + n] = inverse
        chain = np.arange(first, first + (LOAD_COEFFICIENTS - 1) * n)
        whole[chain, chain + n] = 1.0
        rows = exponentials(whole, np.array([dt * NS]))[0, : 2 * n]
        load = [rows[:, first + k * n : first + (k + 1) * n] for k in range(LOAD_COEFFICIENTS)]
        return Step(rows[:, : 2 * n], rows[:, 2 * n : first], np.array(load))


def structure(spec: Spec) -> Structure:
    """Numerical substructure that a spec says is computed with."""
    built = as_built(spec, "numerical")
    assert built.numerical is not None
    body, sides = substructure(built.numerical), interface(built)
    return Structure(body.mass, body.damping, body.stiffness, sides.stiffness, sides.damping, sides.numerical)
