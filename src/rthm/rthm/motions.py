"""Simulated motions, as results."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from rthm.results import Column, Result
from rthm_core import engine
from rthm_core.spec import Spec


def _signals(spec: Spec) -> Iterator[tuple[str, str, list[str]]]:
    """Arrays of a trajectory, with the unit and the names of their columns."""
    numerical = spec.numerical.dofs if spec.numerical else ()
    actuators = spec.actuator.names if spec.actuator else ()
    for side, dofs in (("plant", spec.plant.dofs), ("numerical", numerical)):
        yield f"{side}_position", "m", [f"{dof}.position" for dof in dofs]
        yield f"{side}_velocity", "m/s", [f"{dof}.velocity" for dof in dofs]
    yield "force_reference", "N", [f"{name}.force_reference" for name in actuators]
    yield "actuator_force", "N", [f"{name}.force" for name in actuators]


def _columns(spec: Spec, motion: object, mark: str = "{}", unit: str = "{}") -> dict[str, Column]:
    """Columns of a motion; the templates say how names and units are told."""
    return {
        mark.format(name): Column(getattr(motion, array)[..., i], unit.format(of))
        for array, of, names in _signals(spec)
        for i, name in enumerate(names)
    }


@dataclass
class Simulation(Result, engine.Trajectory):
    """A simulated motion: a `Trajectory` that knows its spec.

    Attributes
    ----------
    t : (N,) array
        s.
    plant_position, plant_velocity, numerical_position, numerical_velocity : (N, n) arrays
        m, m/s.
    force_reference, actuator_force : (N, m) arrays
        F_d in use by the controller, and the force in the wire, N.
    energies : dict of (N,) arrays
        ``E_num``, ``E_ff``, ``E_fx``, ``E_err``, ``E_damping``, ``E_load``, ``E_effects``, ``E_total``, J.
    spec : Spec
    """

    spec: Spec = field(kw_only=True, repr=False)

    def columns(self) -> dict[str, Column]:
        """Time, motion, forces, energies."""
        energies = {name: Column(values, "J") for name, values in self.energies.items()}
        return {"t": Column(self.t, "s"), **_columns(self.spec, self), **energies}

    def shown(self) -> Sequence[str]:
        """Positions, forces of the wires, energies that delays and holds brought in."""
        ends, errors = (".position", ".force"), ("E_num", "E_ff", "E_fx", "E_err")
        return [name for name in self.columns() if name.endswith(ends) or name in errors]


@dataclass
class Derivatives(Result, engine.Sensitivities):
    """A simulated motion, ``trajectory``, and its derivatives ``by_parameter``.

    Attributes
    ----------
    trajectory : Trajectory
    by_parameter : dict of Trajectory
        Derivative of each array with respect to one number of the spec, in SI units over that number's.
    tangents : bool
        Whether they were computed beside the trajectory, or by differences of whole simulations.
    spec : Spec
    """

    spec: Spec = field(kw_only=True, repr=False)

    def columns(self) -> dict[str, Column]:
        """Time, and ``d x1.position / d plant.mass``."""
        found = {"t": Column(self.trajectory.t, "s")}
        for name, change in self.by_parameter.items():
            found |= _columns(self.spec, change, f"d {{}} / d {name}", f"{{}} per unit of {name}")
        return found

    def shown(self) -> Sequence[str]:
        """Derivatives of the positions."""
        return [name for name in self.columns() if ".position" in name]


@dataclass(frozen=True)
class Ensemble(Result, engine.Ensemble):
    """Simulated motions of L loops.

    Attributes
    ----------
    t : (N,) array
        s.
    plant_position, plant_velocity, numerical_position, numerical_velocity : (L, N, n) arrays
        m, m/s.
    force_reference, actuator_force : (L, N, m) arrays
        N.
    spec : Spec
        What all loops have in common.
    """

    spec: Spec = field(kw_only=True, repr=False)

    def columns(self) -> dict[str, Column]:
        """Time, and ``x1.position[0]`` of the first loop and so on."""
        found = {"t": Column(self.t, "s")}
        for name, (values, unit) in _columns(self.spec, self).items():
            found |= {f"{name}[{loop}]": Column(one, unit) for loop, one in enumerate(values)}
        return found

    def shown(self) -> Sequence[str]:
        """Positions of the plant."""
        ends = tuple(f"{dof}.position" for dof in self.spec.plant.dofs)
        return [name for name in self.columns() if name.startswith(ends)]
