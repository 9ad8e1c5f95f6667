"""What must hold between the channels of a recording, whatever the rig is like, and how well it does."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import (
    ELASTIC_GAIN,
    KINEMATIC_GAIN,
    MOTOR_GAIN,
    RELATED_CORRELATION,
    SOUND_CORRELATION,
)
from rthm_analysis.diagnosis.faults.smooth import Smooth

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec

Name = tuple[str, str]
"""Family and place of a signal."""


@dataclass(frozen=True)
class Relation:
    """One relation between signals.

    Attributes
    ----------
    signals : tuple of Name
        What is measured in it.
    gain : float
        What the one is times the other; 1 where all is well.
    correlation : float
        Between the two; its sign is that of the gain.
    allowed : (float, float)
        Gains at which it holds.
    """

    signals: tuple[Name, ...]
    gain: float
    correlation: float
    allowed: tuple[float, float]

    @property
    def holds(self) -> bool:
        """Whether it holds, as good as rigs are."""
        return self.correlation > RELATED_CORRELATION and self.allowed[0] <= self.gain <= self.allowed[1]

    @property
    def sound(self) -> bool:
        """Whether it holds beyond doubt."""
        return self.holds and self.correlation > SOUND_CORRELATION


@dataclass(frozen=True)
class Wire:
    """One wire: between which motor and which dof, N/m, and how far its stiffness is known."""

    actuator: str
    dof: str
    stiffness: float
    uncertainty: float


def wires_of(spec: Spec) -> tuple[Wire, ...]:
    """Wires of a loop; none in a plant alone."""
    if not spec.is_loop or spec.actuator is None or spec.interface is None:
        return ()
    unsure = spec.uncertainty.actuator.stiffness
    return tuple(
        Wire(name, dof, stiffness, unsure)
        for name, dof, stiffness in zip(
            spec.actuator.names, spec.interface.plant_dof, spec.k_tot, strict=True
        )
    )


def related(one: Floats, other: Floats) -> tuple[float, float]:
    """Gain and correlation of `other` over `one`: the ratio of their spreads, with the sign of the
    correlation.
    """
    a, b = one - one.mean(), other - other.mean()
    spread = float(np.sqrt((a @ a) * (b @ b)))
    if not spread > 0.0 or not np.isfinite(spread):
        return np.nan, 0.0
    correlation = float(a @ b) / spread
    return float(np.copysign(np.sqrt((b @ b) / (a @ a)), correlation)), correlation


def kinematic(smooth: Smooth, dof: str) -> Relation | None:
    """``v = dx/dt`` at a dof."""
    x, v = ("position", dof), ("velocity", dof)
    if x not in smooth.values or v not in smooth.values:
        return None
    return Relation((x, v), *related(smooth.rates[x], smooth.values[v]), KINEMATIC_GAIN)


def accelerated(smooth: Smooth, dof: str) -> Relation | None:
    """``a = dv/dt`` at a dof, or ``d2x/dt2`` where its velocity is not measured."""
    x, v, a = (("position", dof), ("velocity", dof), ("acceleration", dof))
    if a not in smooth.values or not (v in smooth.values or x in smooth.values):
        return None
    slow, rate = (v, smooth.rates[v]) if v in smooth.values else (x, smooth.seconds[x])
    return Relation((slow, a), *related(rate, smooth.values[a]), KINEMATIC_GAIN)


def followed(smooth: Smooth, wire: Wire) -> Relation | None:
    """The motor's position is what was commanded."""
    u, c = ("motor", wire.actuator), ("command", wire.actuator)
    if u not in smooth.values or c not in smooth.values:
        return None
    return Relation((u,), *related(smooth.values[c], smooth.values[u]), MOTOR_GAIN)


def elastic(smooth: Smooth, wire: Wire) -> Relation | None:
    """``F = k_tot (u - x)`` in a wire; commands in place of a motor that was not measured."""
    names = wire_signals(smooth, wire)
    if names is None:
        return None
    force, motor, position = names
    longer = wire.stiffness * (smooth.values[motor] - smooth.values[position])
    gain, correlation = related(longer, smooth.values[force])
    measured = tuple(one for one in names if one[0] != "command")
    slack = 2.0 * wire.uncertainty
    return Relation(
        measured, gain, correlation, (ELASTIC_GAIN[0] / (1.0 + slack), ELASTIC_GAIN[1] * (1.0 + slack))
    )


def wire_signals(smooth: Smooth, wire: Wire) -> tuple[Name, Name, Name] | None:
    """Force, motor (or command) and position of a wire; None where one is missing."""
    motor: Name = ("motor", wire.actuator)
    if motor not in smooth.values:
        motor = ("command", wire.actuator)
    names: tuple[Name, Name, Name] = (("force", wire.actuator), motor, ("position", wire.dof))
    return names if all(one in smooth.values for one in names) else None


def relations(smooth: Smooth, dofs: tuple[str, ...], wires: tuple[Wire, ...]) -> list[Relation]:
    """All relations between what was measured."""
    all_of_them = [of(smooth, dof) for dof in dofs for of in (kinematic, accelerated)]
    for wire in wires:
        all_of_them += [followed(smooth, wire), elastic(smooth, wire)]
    return [one for one in all_of_them if one is not None]


def exchanged(smooth: Smooth, one: Name, other: Name) -> Smooth:
    """Smoothed signals in which two have changed their places."""
    places = {one: other, other: one}

    def over(known: dict[Name, Floats]) -> dict[Name, Floats]:
        return {places.get(name, name): column for name, column in known.items()}

    return replace(smooth, values=over(smooth.values), rates=over(smooth.rates), seconds=over(smooth.seconds))


def corrected(smooth: Smooth, factors: dict[Name, float]) -> Smooth:
    """Smoothed signals, each over its factor."""

    def over(known: dict[Name, Floats]) -> dict[Name, Floats]:
        return {name: column / factors.get(name, 1.0) for name, column in known.items()}

    return replace(smooth, values=over(smooth.values), rates=over(smooth.rates), seconds=over(smooth.seconds))
