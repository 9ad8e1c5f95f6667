"""Put the physical side together: from the spec to the arrays that the compiled code works on.

The mechanics are one linear system with nonlinear forces fed back into it,

    dy/dt = A y + B_u u + B_w w + B_F F + B_p f,

with the motor positions u, the loads w, the forces F of wires that are not linear and the forces f of laws
that are not linear. Linear laws are
probed with unit motions and become part of A, so that their equation, too, is written once.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers
from rthm_core.errors import InputError
from rthm_core.linear import LinearSystem, linear_system
from rthm_core.loads import Load, Loads, load, sinusoid, together
from rthm_core.physical.drive import Drive, drive
from rthm_core.physical.laws import (
    DOF,
    NONLINEAR,
    PULLEY,
    LawTable,
    Place,
    WireTable,
    law_table,
    nonlinear_wires,
    plant_laws,
    wire_laws,
    wire_table,
)
from rthm_core.physical.sensors import Sensors, sensor_states, sensors
from rthm_core.spec.effect import sizes
from rthm_core.substructure import Substructure, free_dynamics, substructure

if TYPE_CHECKING:
    from rthm_core.spec import Spec


Resting = tuple[Any, tuple[float, ...], Place | int, int]
"""A law with own states: law, parameters, its place on the plant or its actuator, and its first own state."""


class PhysicalModel(NamedTuple):
    """Everything that the compiled code needs to know of motor, wire and plant.

    The state is ``whole = [q, y]`` with the motor chain q (nq,) and the mechanics y (ny,) = [x, v,
    transmission, own states of laws, sensor lags];
    ``dy/dt = mechanics [y, u, w, F, f]``. `laws` is None when all is linear.
    """

    n: int
    m: int
    drive: Drive
    whole: LinearSystem
    mechanics: Floats
    inverse_mass: Floats
    loads: Loads
    load_dof: Integers
    listed_loads: int
    wires: WireTable
    laws: LawTable | None
    sensors: Sensors


class Mechanical(NamedTuple):
    """Plant, wires and laws of a spec, put together.

    Attributes
    ----------
    parts : _Assembly
    wires : WireTable
    laws : LawTable or None
        None when all is linear.
    sensors : Sensors
    resting : list
        Laws with own states, for their values at the start of a test.
    """

    parts: _Assembly
    wires: WireTable
    laws: LawTable | None
    sensors: Sensors
    resting: list[Resting]

    @property
    def n(self) -> int:
        """Number of dofs."""
        return self.parts.n

    @property
    def matrix(self) -> Floats:
        """``dy/dt = matrix [y, u, w, F, f]``."""
        parts = self.parts
        return np.asarray(np.hstack([parts.a, parts.b_u, parts.b_w, parts.b_f, parts.b_p]), dtype=float)


class _Assembly:
    """Matrices under construction; one method per part of the physics."""

    def __init__(self, spec: Spec, plant: Substructure, m: int, size: int, loads: int, laws: int) -> None:
        self.spec, self.plant, self.n, self.m = spec, plant, plant.dofs, m
        self.free, self.inverse_mass = free_dynamics(plant.mass, plant.damping, plant.stiffness)
        self.a = np.zeros((size, size))
        self.b_u, self.b_w = np.zeros((size, m)), np.zeros((size, loads))
        self.b_f, self.b_p = np.zeros((size, m)), np.zeros((size, laws))

    def push(self, dof: int) -> Floats:
        """Effect of a unit force on a dof on dy/dt."""
        column = np.zeros(self.a.shape[0])
        column[self.n : 2 * self.n] = self.inverse_mass[:, dof]
        return column

    def push_at(self, place: Place) -> Floats:
        """Effect of a unit force of a law on dy/dt."""
        column = np.zeros(self.a.shape[0])
        column[self.n : 2 * self.n] = place.apart(self.inverse_mass)
        return column

    def add_plant(self) -> None:
        motion = slice(2 * self.n)
        self.a[motion, motion] = self.free

    def add_transmission(self, actuator: int, at: int) -> None:
        """Pulley of (3a), in metres at the wire: p = theta_w r_w."""
        assert self.spec.actuator is not None and self.spec.actuator.transmission is not None
        t = self.spec.actuator.transmission
        mass, damping, stiffness = t.inertia / t.radius**2, t.damping / t.radius**2, t.spring / t.radius**2
        if mass > 0.0:
            self.a[at, at + 1] = 1.0
            self.a[at + 1, at], self.a[at + 1, at + 1] = -stiffness / mass, -damping / mass
            self.b_u[at + 1, actuator], self.b_f[at + 1, actuator] = stiffness / mass, -1.0 / mass
        else:
            self.a[at, at] = -stiffness / damping
            self.b_u[at, actuator], self.b_f[at, actuator] = stiffness / damping, -1.0 / damping

    def add_linear_law(self, law: Any, p: tuple[float, ...], place: Place, at: int) -> None:
        """Probe a linear law with unit motions."""
        n, states, rows = self.n, law.states, np.zeros((2 + law.states, self.a.shape[0]))
        rows[0, :n] = rows[1, n : 2 * n] = place.apart(np.eye(n))
        rows[2:, at : at + states] = np.eye(states)
        for row, unit in zip(rows, np.eye(2 + states), strict=True):
            z, dz, effect = list(unit[2:]), [0.0] * states, np.zeros(self.a.shape[0])
            law.rate(unit[0], unit[1], z, 0.0, p, 0, dz)
            effect[at : at + states] = dz
            effect += self.push_at(place) * law.force(unit[0], unit[1], z, 0.0, p, 0)
            self.a += np.outer(effect, row)

    def add_linear_wire(self, wires: WireTable, actuator: int, laws: list[Any]) -> None:
        """Probe a linear wire for its force and fold it into the dynamics."""
        n, dof, k = self.n, int(wires.numbers[actuator, DOF]), float(wires.stiffness[actuator, 0])
        states = [(law, p, at) for law, p, a, at in laws if a == actuator]
        columns = [dof, n + dof, *[at + j for law, _, at in states for j in range(law.states)]]
        for i in range(1 + len(columns)):
            unit = np.zeros(1 + len(columns))
            unit[i] = 1.0
            force, begin = k * (unit[0] - unit[1]), 3
            for law, p, at in states:
                z, dz = list(unit[begin : begin + law.states]), [0.0] * law.states
                force = law.force(unit[0], unit[1], unit[2], k, force, z, p)
                law.rate(unit[0], unit[1], unit[2], k, z, p, dz)
                self._add_drive_or_motion(
                    wires, actuator, i, columns, slice(at, at + law.states), np.array(dz)
                )
                begin += law.states
            unit_row = np.eye(wires.drive.shape[1])
            wires.force[actuator] += force * (wires.drive[actuator] if i == 0 else unit_row[columns[i - 1]])
        size = self.a.shape[0]
        self.a += np.outer(self.b_f[:, actuator], wires.force[actuator, :size])
        self.b_u += np.outer(self.b_f[:, actuator], wires.force[actuator, size:])
        self.b_f[:, actuator] = 0.0

    def _add_drive_or_motion(
        self, wires: WireTable, actuator: int, i: int, columns: list[int], rows: slice, dz: Floats
    ) -> None:
        if i == 0:
            size = self.a.shape[0]
            self.a[rows] += np.outer(dz, wires.drive[actuator, :size])
            self.b_u[rows] += np.outer(dz, wires.drive[actuator, size:])
        else:
            self.a[rows, columns[i - 1]] += dz


def _loads(spec: Spec, further: list[tuple[Load, int]]) -> tuple[list[Load], list[int], int]:
    """All forces on the plant that depend on time alone, their dofs, and how many of them are listed in the
    spec's ``load``.
    """
    assert spec.plant is not None
    section = spec.load.plant
    loads, dofs = (
        [load(section)],
        [spec.plant.dofs.index(section.dof) if section is not None and section.dof else 0],
    )
    loads, dofs = loads + [one for one, _ in further], dofs + [dof for _, dof in further]
    listed = len(loads)
    for law, p, place in plant_laws(spec):
        for dof, shape in excitations(law, p, place):
            loads.append(sinusoid(*shape))
            dofs.append(dof)
    return loads, dofs, listed


def excitations(
    law: Any, p: tuple[float, ...], place: Place
) -> list[tuple[int, tuple[float, float, float, float]]]:
    """Dofs, and constant, amplitude, frequency and phase of the force there, of a law of time alone; else
    none.
    """
    shape = law.excitation(p)
    if shape is None:
        return []
    constant, amplitude, frequency, phase = shape
    opposite = [(place.other, (-constant, -amplitude, frequency, phase))] if place.other >= 0 else []
    return [(place.dof, shape), *opposite]


def physical_model(
    spec: Spec, body: Substructure | None = None, further: list[tuple[Load, int]] | None = None
) -> tuple[PhysicalModel, list[Resting]]:
    """Physical side of a spec: with actuators when it has them, else a plant under known forces.

    Parameters
    ----------
    spec : Spec
        What to build.
    body : Substructure, optional
        Moves instead of the plant, without actuators; its first dofs are the plant's.
    further : list of (Load, dof), optional
        Known loads beside the spec's load on the plant.

    Returns
    -------
    model : PhysicalModel
        What compiled code works on.
    resting : list
        Laws with own states, for their values at the start of a test.

    Raises
    ------
    InputError
        When the spec has no plant.
    """
    loads, load_dofs, listed = _loads(spec, further or [])
    built = mechanical(spec, body, load_dofs, listed, measured=body is None)
    orders = max([one.orders for one in loads] + [2 if _limits_rate(spec) else 1])
    motors = drive(spec, orders, actuators=built.parts.m)
    model = PhysicalModel(
        built.n,
        built.parts.m,
        motors,
        _whole(motors, built.parts, orders),
        built.matrix,
        np.asarray(built.parts.inverse_mass, dtype=float),
        together(loads),
        np.array(load_dofs, dtype=np.int64),
        listed,
        built.wires,
        built.laws,
        built.sensors,
    )
    return model, built.resting


def mechanical(
    spec: Spec,
    body: Substructure | None = None,
    load_dofs: Sequence[int] = (),
    known: int = 0,
    *,
    measured: bool = False,
) -> Mechanical:
    """Plant and wires of a spec without motors, with loads on some dofs, of which the first so many are
    known, and its sensors if it is `measured`.

    Raises
    ------
    InputError
        When the spec has no plant.
    """
    if spec.plant is None:
        raise InputError(
            "plant is missing: nothing can be simulated without it; add a plant section with "
            "dofs, mass, damping and stiffness."
        )
    plant = body or substructure(spec.plant)
    m = len(spec.actuator.names) if spec.actuator and body is None else 0
    forces = [(law, p, place) for law, p, place in plant_laws(spec) if law.excitation(p) is None]
    wires, at = wire_table(spec, 2 * plant.dofs, m)
    wire_list, at = wire_laws(spec, at, m)
    law_at = np.cumsum([at, *[law.states for law, _, _ in forces]]).tolist()
    placed = [(law, p, place, z) for (law, p, place), z in zip(forces, law_at, strict=False)]
    nonlinear = [one for one in placed if not one[0].linear]
    size = law_at[-1] + (sensor_states(spec) if measured else 0)
    parts = _Assembly(spec, plant, m, size, len(load_dofs), len(nonlinear))
    parts.add_plant()
    for i, dof in enumerate(load_dofs):
        parts.b_w[:, i] = parts.push(dof)
    for i, (_, _, place, _) in enumerate(nonlinear):
        parts.b_p[:, i] = parts.push_at(place)
    for law, p, place, z in placed:
        if law.linear:
            parts.add_linear_law(law, p, place, z)
    wires = wires.sized(size)
    for actuator in range(m):
        parts.b_f[:, actuator] = parts.push(int(wires.numbers[actuator, DOF]))
        if wires.numbers[actuator, PULLEY] >= 0:
            parts.add_transmission(actuator, int(wires.numbers[actuator, PULLEY]))
    sensed = sensors(spec, parts, law_at[-1], measured=measured)
    for actuator in range(m):
        if not wires.numbers[actuator, NONLINEAR]:
            parts.add_linear_wire(wires, actuator, wire_list)
    resting: list[Resting] = [one for one in placed if one[0].states]
    resting += [one for one in (*wire_list, *nonlinear_wires(wires)) if one[0].states]
    some = nonlinear or wires.numbers[:, NONLINEAR].any()
    laws = law_table(nonlinear, load_dofs[:known], plant.mass) if some else None
    return Mechanical(parts, wires, laws, sensed, resting)


def _limits_rate(spec: Spec) -> bool:
    return bool(sizes(spec.effects, "motor", "rate"))


def _whole(motors: Drive, parts: _Assembly, orders: int) -> LinearSystem:
    """Motor chain and mechanics as one linear system with the inputs [commands, loads]."""
    nq, ny, m = motors.system.a.shape[0], parts.a.shape[0], parts.m
    a, b = np.zeros((nq + ny, nq + ny)), np.zeros((nq + ny, m + parts.b_w.shape[1]))
    a[:nq, :nq], a[nq:, :nq], a[nq:, nq:] = motors.system.a, parts.b_u @ motors.out[:, :nq], parts.a
    b[:nq, :m], b[nq:, :m], b[nq:, m:] = motors.system.b, parts.b_u @ motors.out[:, nq:], parts.b_w
    return linear_system(a, b, orders)
