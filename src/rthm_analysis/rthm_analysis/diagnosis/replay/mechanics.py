"""From a spec to the plant and wires that a replay moves: the simulator's, with a load on every dof."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np

from rthm_core.compiled import Floats
from rthm_core.physical.laws import DOF, NONLINEAR, LawTable, WireTable, law_table, place_of, reads_load
from rthm_core.physical.model import mechanical
from rthm_core.physical.side import first_command
from rthm_core.physical.start import rest

if TYPE_CHECKING:
    from rthm_core.effects.laws import PlantLaw
    from rthm_core.spec import Spec

NO_LAWS = law_table([])


class Mechanics(NamedTuple):
    """Those parts of a ``rthm_core.physical.model.PhysicalModel`` that `mechanics_rate` works on.

    Attributes
    ----------
    n, m : int
        Dofs and actuators.
    mechanics : (ny, ny + m + loads + m + L) array
        ``dy/dt = mechanics [y, u, w, F, f]`` with a load w on each dof; with two, the known ones first, where
        a law depends on these.
    inverse_mass : (n, n) array
    wires : WireTable
    laws : LawTable
        A table without rows where all is linear, so that every spec runs the same compiled code.
    initial : (ny,) array
        State before the test.
    """

    n: int
    m: int
    mechanics: Floats
    inverse_mass: Floats
    wires: WireTable
    laws: LawTable
    initial: Floats

    @property
    def a(self) -> Floats:
        """Linear mechanics (ny, ny)."""
        return self.mechanics[:, : self.initial.size]

    @property
    def by_motors(self) -> Floats:
        """Effect (ny, m) of the motor positions."""
        return self.mechanics[:, self.initial.size :][:, : self.m]

    @property
    def loads(self) -> int:
        """Number of loads."""
        return int(self.mechanics.shape[1] - self.initial.size - 2 * self.m - self.laws.numbers.shape[0])

    @property
    def by_loads(self) -> Floats:
        """Effect (ny, n) of a load on each dof."""
        return self.mechanics[:, self.initial.size + self.m :][:, : self.n]

    @property
    def by_wires(self) -> Floats:
        """Effect (ny, m) of the forces of wires that are not linear."""
        return self.mechanics[:, self.initial.size + self.m + self.loads :][:, : self.m]


def mechanics(spec: Spec, first_motor: Floats | None = None) -> Mechanics:
    """Plant and wires of a spec whose sensors and motors are left to others.

    Parameters
    ----------
    spec : Spec
        With a plant.
    first_motor : (m,) array, optional
        Motor positions before the test; by default what the spec's first command gives.
    """
    assert spec.plant is not None
    n = len(spec.plant.dofs)
    dofs = [*range(n)]
    built = mechanical(spec, load_dofs=dofs * 2 if _any_reads_load(spec) else dofs, known=n)
    initial = np.zeros(built.parts.a.shape[0])
    initial[:n], initial[n : 2 * n] = spec.plant.initial_position, spec.plant.initial_velocity
    rest(built, built.resting, initial, first_command(spec) if first_motor is None else first_motor)
    return Mechanics(
        n,
        built.parts.m,
        built.matrix,
        built.parts.inverse_mass,
        built.wires,
        NO_LAWS if built.laws is None else built.laws,
        initial,
    )


def _any_reads_load(spec: Spec) -> bool:
    """Whether a law on the plant depends on the known load."""
    return any(one.block == "plant" and reads_load(one.law) for one in spec.effects)


def wire_forces(mechanics: Mechanics) -> Floats:
    """Force of every wire, N, as a row (m, ny) over the states: that of its spring where it is not linear."""
    size, wires = mechanics.initial.size, mechanics.wires
    rows = wires.force[:, :size].copy()
    for actuator in np.flatnonzero(wires.numbers[:, NONLINEAR]):
        stiffness = wires.stiffness[actuator, 0]
        rows[actuator] = stiffness * wires.drive[actuator, :size]
        rows[actuator, wires.numbers[actuator, DOF]] -= stiffness
    return rows


def state_matrix(mechanics: Mechanics) -> Floats:
    """State matrix (ny, ny) with taut, linear wires and without the laws of the plant that are not linear."""
    return np.asarray(mechanics.a + mechanics.by_wires @ wire_forces(mechanics))


def fastest(mechanics: Mechanics, spec: Spec) -> float:
    """Largest rate (rad/s) of the mechanics with contacts closed and wires taut."""
    return float(np.abs(modes(mechanics, spec)).max(initial=0.0))


def modes(mechanics: Mechanics, spec: Spec) -> np.ndarray:
    """Eigenvalues (rad/s) of the mechanics with contacts closed and wires taut."""
    a, n = state_matrix(mechanics), mechanics.n
    for effect in spec.effects:
        if effect.block == "plant":
            reach = place_of(spec, effect).apart(np.eye(n))
            stiffness, damping = cast("type[PlantLaw]", effect.law).steepest(effect.numbers)
            push = np.outer(mechanics.inverse_mass @ reach, reach)
            a[n : 2 * n, :n] -= abs(stiffness) * push
            a[n : 2 * n, n : 2 * n] -= damping * push
    return np.asarray(np.linalg.eigvals(a))
