"""Sections of a spec, except loads and effects: every field with unit, bounds and description."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict

from rthm_core.clock import to_ns
from rthm_core.compensators import HIGHEST_ORDER, NAMES, RESERVED
from rthm_core.spec.entries import Choice, Entry, Names, Number, Numbers, Whole

LONGEST_TIME = 3600.0
SHORTEST_PERIOD = 1e-6
ON_ABORT = ("return", "hold", "unload")


class Section(BaseModel):
    """A section of a spec: immutable, and without keys beside its fields."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @classmethod
    def entries(cls) -> Iterator[tuple[str, Entry]]:
        """Name and entry of every field that is not a section itself."""
        for name, field in cls.model_fields.items():
            yield from ((name, entry) for entry in field.metadata if isinstance(entry, Entry))

    def items(self) -> Iterator[tuple[str, Any]]:
        """Name and value of every field."""
        return ((name, getattr(self, name)) for name in type(self).model_fields)


class SubstructureSpec(Section):
    """Substructure with n degrees of freedom, ``M a = -C v - K x + forces``; matrices row-major, n*n."""

    dofs: Annotated[tuple[str, ...], Names("names of the degrees of freedom, one for each")]
    mass: Annotated[tuple[float, ...], Numbers("kg", "mass matrix M, symmetric and positive definite")]
    damping: Annotated[tuple[float, ...], Numbers("N s/m", "damping matrix C")]
    stiffness: Annotated[tuple[float, ...], Numbers("N/m", "stiffness matrix K, symmetric")]
    initial_position: Annotated[tuple[float, ...], Numbers("m", "position at the start, of every dof")]
    initial_velocity: Annotated[tuple[float, ...], Numbers("m/s", "velocity at the start, of every dof")]

    @property
    def n(self) -> int:
        """Number of degrees of freedom."""
        return len(self.dofs)


MATRICES: dict[str, str] = {
    name: entry.unit for name, entry in SubstructureSpec.entries() if name in ("mass", "damping", "stiffness")
}
"""Matrices of a substructure, in the order of M, C and K, and the units of their entries."""


class InterfaceSpec(Section):
    """Connection of the substructures, ``F_c = -c2 (v1 - v2) - k2 (x1 - x2)``, one per actuator."""

    plant_dof: Annotated[tuple[str, ...], Names("dof of the plant at which each actuator pulls")]
    numerical_dof: Annotated[tuple[str, ...], Names("dof of the numerical substructure at the other end")]
    stiffness: Annotated[tuple[float, ...], Numbers("N/m", "stiffness k2 of each connection")]
    damping: Annotated[tuple[float, ...], Numbers("N s/m", "damping c2 of each connection")]


class TransmissionSpec(Section):
    """Clock spring, pulley and wire of the paper's (3a); replaces ``stiffness`` of every actuator."""

    spring: Annotated[float, Number("N m/rad", "clock spring k_theta", above=0.0)]
    wire: Annotated[float, Number("N/m", "wire k_w", above=0.0)]
    radius: Annotated[float, Number("m", "pulley radius r_w", above=0.0)]
    inertia: Annotated[float, Number("kg m^2", "inertia I of the pulley", minimum=0.0)]
    damping: Annotated[float, Number("N m s/rad", "rotational damping c_theta of the pulley", minimum=0.0)]

    @property
    def k_tot(self) -> float:
        """Stiffness of wire and spring in series, N/m: ``1 / (1/k_w + r_w^2/k_theta)``, the corrected (5)."""
        return 1.0 / (1.0 / self.wire + self.radius**2 / self.spring)

    @property
    def moves(self) -> bool:
        """Whether the pulley has a motion of its own: without inertia and damping it is a spring."""
        return self.inertia > 0.0 or self.damping > 0.0


class ActuatorSpec(Section):
    """Actuators: a motor ``h(s)`` that pulls at the plant over an elastic wire, ``F = k_tot (u - x1)``."""

    names: Annotated[tuple[str, ...], Names("names of the actuators, one for each")]
    stiffness: Annotated[
        tuple[float, ...] | None,
        Numbers("N/m", "k_tot of each actuator; not needed beside a transmission", above=0.0),
    ] = None
    pretension: Annotated[
        tuple[float, ...], Numbers("N", "tension of each wire at rest; 0: never slack", minimum=0.0)
    ]
    motor_poles: Annotated[
        tuple[float, ...] | None,
        Numbers(
            "rad/s",
            "poles kv and ka of every motor, h(s) = 1/((1 + s/kv)(1 + s/ka)); absent: h(s) = 1",
            above=0.0,
            count=2,
        ),
    ] = None
    transmission: TransmissionSpec | None = None
    compensator: Annotated[str, Choice((*NAMES, *RESERVED), "how the controller makes up for delays")] = (
        "none"
    )
    compensator_order: Annotated[
        int,
        Whole("1", "order of the polynomials of a polynomial compensator", minimum=1, maximum=HIGHEST_ORDER),
    ] = 2
    compensator_horizon: Annotated[
        float | None,
        Number(
            "s",
            "time from a command to its effect at the wire, as the compensator believes in it; "
            "absent: tau4 + 1/kv + 1/ka",
            minimum=0.0,
            maximum=LONGEST_TIME,
        ),
    ] = None

    @property
    def k_tot(self) -> tuple[float, ...]:
        """Stiffness between motor and plant, in N/m, of every actuator."""
        if self.transmission is not None:
            return (self.transmission.k_tot,) * len(self.names)
        return self.stiffness or ()


def _period(description: str) -> Number:
    return Number("s", description, minimum=SHORTEST_PERIOD, maximum=LONGEST_TIME)


def _delay(description: str) -> Number:
    return Number("s", description, minimum=0.0, maximum=LONGEST_TIME)


class TimingSpec(Section):
    """Periods and delays of the loop, in s."""

    td1: Annotated[float, _period("period Td1 of the data acquisition")]
    td2: Annotated[float, _period("period Td2 of the numerical substructure")]
    td3: Annotated[float, _period("period Td3 of the controller, which holds z1")]
    td4: Annotated[
        float, _delay("period Td4 at which the controller takes the force reference; 0: as soon as it is due")
    ]
    tau1: Annotated[float, _delay("delay of the plant's state to the controller")]
    tau2: Annotated[float, _delay("delay of the plant's state to the numerical substructure")]
    tau3: Annotated[float, _delay("delay of the force reference to the controller")]
    tau4: Annotated[float, _delay("delay of the command to the motor")]

    def ns(self, name: str) -> int:
        """Return a period or delay, such as ``"tau1"``, in integer ns."""
        return to_ns(getattr(self, name))


class NoiseSpec(Section):
    """Noise of the simulated sensors: white, standard deviation per sample."""

    position: Annotated[float, Number("m", "noise of the plant's positions", minimum=0.0)] = 0.0
    velocity: Annotated[float, Number("m/s", "noise of the plant's velocities", minimum=0.0)] = 0.0
    motor: Annotated[float, Number("m", "noise of the motor positions", minimum=0.0)] = 0.0
    force: Annotated[float, Number("N", "noise of the actuator forces", minimum=0.0)] = 0.0
    seed: Annotated[int, Whole("1", "number from which every random draw of a test follows")] = 0


def _spread(what: str) -> Number:
    return Number("1", f"relative standard deviation of {what}; 0: exact", minimum=0.0, maximum=100.0)


class PlantUncertainty(Section):
    """How well the plant is known."""

    mass: Annotated[float, _spread("the plant's masses")] = 0.0
    damping: Annotated[float, _spread("the plant's dampings")] = 0.0
    stiffness: Annotated[float, _spread("the plant's stiffnesses")] = 0.0


class ActuatorUncertainty(Section):
    """How well the actuators are known."""

    stiffness: Annotated[float, _spread("k_tot of the real wire")] = 0.0


class UncertaintySpec(Section):
    """Which physical properties are not known exactly."""

    plant: PlantUncertainty = PlantUncertainty()
    actuator: ActuatorUncertainty = ActuatorUncertainty()


class ZeroSpec(Section):
    """What the sensors of a rig read where nothing moves and nothing pulls; its driver subtracts it.

    ``rthm zero`` and ``rthm pretension`` write it.
    """

    position: Annotated[tuple[float, ...] | None, Numbers("m", "reading of every dof")] = None
    velocity: Annotated[tuple[float, ...] | None, Numbers("m/s", "reading of every dof")] = None
    motor: Annotated[
        tuple[float, ...] | None, Numbers("m", "reading of every motor; commands are given from there")
    ] = None
    force: Annotated[
        tuple[float, ...] | None, Numbers("N", "reading of every load cell, its pretension included")
    ] = None
    tension: Annotated[
        tuple[float, ...] | None, Numbers("N", "pretension of every wire, as it was measured", minimum=0.0)
    ] = None


class LimitsSpec(Section):
    """What the safety monitor of the actuator allows; an absent entry is no limit, or has the default of
    docs/safety.md.
    """

    command: Annotated[float | None, Number("m", "largest command u_d, either way", above=0.0)] = None
    rate: Annotated[float | None, Number("m/s", "largest rate of the command", above=0.0)] = None
    force: Annotated[float | None, Number("N", "largest force, either way", above=0.0)] = None
    stale: Annotated[
        float | None, Number("s", "age of the data in use at which the monitor ends the test", above=0.0)
    ] = None
    ramp: Annotated[float | None, Number("s", "time over which commands fade in and out", minimum=0.0)] = None
    on_abort: Annotated[str, Choice(ON_ABORT, "where the motors go when a limit is broken")] = "return"
    start: Annotated[
        tuple[float, ...] | None,
        Numbers("m, N", "largest difference between rig and spec before a test", above=0.0, count=2),
    ] = None
    age: Annotated[float | None, Number("s", "largest age of the state in use", above=0.0)] = None
    command_age: Annotated[
        float | None, Number("s", "age of a command that the plant side no longer executes", above=0.0)
    ] = None
    step: Annotated[
        float | None, Number("m", "largest step between two samples of a measured position", above=0.0)
    ] = None
    frozen: Annotated[
        float | None, Number("s", "how long a sensor may not change while the command moves", above=0.0)
    ] = None
    hold: Annotated[float | None, Number("s", "how long a command may be at a limit", above=0.0)] = None
    heartbeat: Annotated[
        float | None, Number("s", "longest silence of a node, or of an operator's heartbeat", above=0.0)
    ] = None
    position: Annotated[float | None, Number("m", "largest measured position, either way", above=0.0)] = None
    velocity: Annotated[float | None, Number("m/s", "largest measured velocity", above=0.0)] = None
    measured_force: Annotated[float | None, Number("N", "largest measured force", above=0.0)] = None
    following: Annotated[
        float | None, Number("m", "largest distance of a motor from its command", above=0.0)
    ] = None
    clock: Annotated[
        float | None,
        Number(
            "s", "largest offset between clocks of hosts; by default a tenth of the shortest tau", above=0.0
        ),
    ] = None
