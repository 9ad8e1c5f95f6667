"""The two substructures and the interface between them, as matrices."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec import Spec
    from rthm_core.spec.schema import SubstructureSpec


class Substructure(NamedTuple):
    """Linear part of a substructure, ``M a = -C v - K x + forces``.

    Attributes
    ----------
    mass, damping, stiffness : (n, n) arrays
        kg, N s/m, N/m.
    position, velocity : (n,) arrays
        Initial motion, m and m/s.
    """

    mass: Floats
    damping: Floats
    stiffness: Floats
    position: Floats
    velocity: Floats

    @property
    def dofs(self) -> int:
        """Number of degrees of freedom."""
        return int(self.position.size)


def natural_frequencies(mass: Floats, stiffness: Floats) -> Floats:
    """Undamped natural frequencies (n,), rad/s, ascending, from (n, n) matrices; 0: it does not swing.

    Examples
    --------
    >>> natural_frequencies(np.diag([1.0, 2.0]), np.diag([4.0, 2.0]))
    array([1., 2.])
    """
    squares = np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real
    return np.asarray(np.sqrt(np.maximum(np.sort(squares), 0.0)), dtype=float)


class Interface(NamedTuple):
    """Springs and dampers between the substructures, one per actuator.

    ``F_c = -c2 (v1 - v2) - k2 (x1 - x2)`` acts on the plant; its opposite acts on the numerical substructure.
    """

    plant: Integers
    numerical: Integers
    stiffness: Floats
    damping: Floats

    @property
    def actuators(self) -> int:
        """Number of actuators."""
        return int(self.stiffness.size)

    def force(self, x1: Floats, v1: Floats, x2: Floats, v2: Floats) -> Floats:
        """F_c (m,), in N, from the motion (m,) of both sides at the interface."""
        return -self.damping * (v1 - v2) - self.stiffness * (x1 - x2)


def substructure(section: SubstructureSpec) -> Substructure:
    """Matrices of a spec section ``plant`` or ``numerical``."""
    n = len(section.dofs)
    square = (n, n)
    return Substructure(
        np.array(section.mass, dtype=float).reshape(square),
        np.array(section.damping, dtype=float).reshape(square),
        np.array(section.stiffness, dtype=float).reshape(square),
        np.array(section.initial_position, dtype=float),
        np.array(section.initial_velocity, dtype=float),
    )


def interface(spec: Spec) -> Interface:
    """Interface of a complete loop.

    Raises
    ------
    InputError
        When the spec describes no loop.
    """
    if spec.interface is None or spec.plant is None or spec.numerical is None:
        raise InputError(
            "interface is missing: a hybrid test needs plant, numerical, interface, actuator "
            "and timing; add the sections or use a spec that has them."
        )
    section = spec.interface
    return Interface(
        np.array([spec.plant.dofs.index(name) for name in section.plant_dof], dtype=np.int64),
        np.array([spec.numerical.dofs.index(name) for name in section.numerical_dof], dtype=np.int64),
        np.array(section.stiffness, dtype=float),
        np.array(section.damping, dtype=float),
    )


def as_built(spec: Spec, block: str) -> Spec:
    """The spec that `block` (``"numerical"`` or ``"controller"``) really computes with: nominal, but for
    the entries that its effects change.
    """
    wrong = {
        str(e.parameters["name"]): float(e.parameters["value"])
        for e in spec.effects
        if e.block == block and e.law.changes == "entry"
    }
    if not wrong:
        return spec
    from rthm_core.spec import apply

    return apply(spec, wrong)


def free_dynamics(mass: Floats, damping: Floats, stiffness: Floats) -> tuple[Floats, Floats]:
    """State matrix of a structure under no force.

    Parameters
    ----------
    mass, damping, stiffness : (..., n, n) arrays
        kg, N s/m, N/m.

    Returns
    -------
    (..., 2 n, 2 n) array
        Of the state [x, v].
    (..., n, n) array
        Inverse of the mass.

    Examples
    --------
    >>> a, inverse = free_dynamics(*(np.array([[one]]) for one in (2.0, 0.4, 6.0)))
    >>> a.tolist(), inverse.tolist()
    ([[0.0, 1.0], [-3.0, -0.2]], [[0.5]])
    """
    n = mass.shape[-1]
    inverse = np.linalg.inv(mass)
    dynamics = np.zeros((*mass.shape[:-2], 2 * n, 2 * n))
    dynamics[..., :n, n:] = np.eye(n)
    dynamics[..., n:, :n], dynamics[..., n:, n:] = -inverse @ stiffness, -inverse @ damping
    return dynamics, np.asarray(inverse)


def held_dynamics(
    mass: Floats, damping: Floats, stiffness: Floats, dofs: Integers, k: Floats, c: Floats
) -> tuple[Floats, Floats]:
    """State matrix of a substructure whose springs and dampers at the interface are held at their other ends.

    Parameters
    ----------
    mass, damping, stiffness : (..., n, n) arrays
        kg, N s/m, N/m.
    dofs : (m,) array
        Dof at which each of the springs and dampers acts.
    k, c : (..., m) arrays
        N/m, N s/m.

    Returns
    -------
    (..., 2 n, 2 n) array
        Of the state [x, v].
    (..., n, n) array
        Inverse of the mass.

    Examples
    --------
    >>> a, inverse = held_dynamics(
    ...     *(np.array([[one]]) for one in (2.0, 0.4, 6.0)), np.array([0]), np.array([4.0]), np.array([0.2])
    ... )
    >>> a.tolist(), inverse.tolist()
    ([[0.0, 1.0], [-5.0, -0.30000000000000004]], [[0.5]])
    """
    interface = np.zeros((mass.shape[-1], dofs.size))
    interface[dofs, np.arange(dofs.size)] = 1.0
    springs, dampers = ((interface * one[..., None, :]) @ interface.T for one in (k, c))
    return free_dynamics(mass, damping + dampers, stiffness + springs)
