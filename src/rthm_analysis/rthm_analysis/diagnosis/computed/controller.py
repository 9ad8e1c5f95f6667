"""Whether the controller computes ``u_d = x1 + F_d / k_tot`` with the k_tot of the spec."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.computed.latched import Latched, delayed
from rthm_analysis.diagnosis.criteria.computed import RIGHT_COMMAND_RMS_SHARE, ROUGHLY_RIGHT_RATIO
from rthm_analysis.recording import Recording
from rthm_core.clock import NS, to_ns
from rthm_core.substructure import as_built
from rthm_core.topics import COMMAND

if TYPE_CHECKING:
    from rthm_core.compiled import Flags, Floats, Integers
    from rthm_core.spec import Spec


@dataclass(frozen=True)
class Commands:
    """Commands of one actuator and what they were computed from.

    Attributes
    ----------
    time : (n,) array
        Stamps, ns after the start.
    u_d, x1, force : (n,) arrays
        Command (m), position (m) and force reference (N) in it; with a compensator, as it predicted them.
    """

    time: Integers
    u_d: Floats
    x1: Floats
    force: Floats

    def rows(self, which: Flags | Integers) -> Commands:
        """Return some of the commands."""
        return Commands(self.time[which], self.u_d[which], self.x1[which], self.force[which])

    def error(self, compliance: float) -> Floats:
        """Recorded commands minus those with ``1 / k_tot = compliance`` (m/N), m."""
        return np.asarray(self.u_d - self.x1 - compliance * self.force)

    def right(self, error: Floats) -> float:
        """Share of the commands without an error beyond rounding."""
        return float(np.mean(np.abs(error) <= RIGHT_COMMAND_RMS_SHARE * self.size)) if error.size else 1.0

    @property
    def size(self) -> float:
        """Rms of u_d, m."""
        return max(float(np.sqrt(np.mean(self.u_d**2))), 1e-12) if self.u_d.size else 1e-12


def held_position(recording: Recording, held: Latched) -> Floats:
    """x1 (n, m) that was in use at each recorded command, m; NaN: not known."""
    time = recording.tables[COMMAND].stamp_ns - recording.start_ns
    motion = held.at(time // held.period)
    return motion[:, : motion.shape[1] // 2]


def commands_of(recording: Recording, spec: Spec, position: Floats, actuator: int) -> Commands:
    """Commands of one actuator whose inputs are all known, without the spans in which they are faded.

    Parameters
    ----------
    position : (n, m) array
        x1 in each recorded command, as it was used or predicted.
    """
    names = spec.loop().actuator.names
    table = recording.tables[COMMAND]
    time = table.stamp_ns - recording.start_ns
    x1 = position[:, actuator]
    u_d, force = (table.columns(field, names)[:, actuator] for field in ("position", "effort"))
    known = np.isfinite(u_d) & np.isfinite(force) & np.isfinite(x1)
    if spec.limits is not None and spec.limits.ramp:
        ramp = to_ns(spec.limits.ramp)
        known &= (time >= ramp) & (time <= time[-1] - ramp)
    return Commands(time, u_d, x1, force).rows(known)


def believed_stiffness(spec: Spec) -> Floats:
    """k_tot (m,) that the spec says the controller computes with, N/m."""
    return np.array(as_built(spec, "controller").k_tot, dtype=float)


def fitted_compliance(commands: Commands) -> tuple[float, float]:
    """1 / k_tot that most of the commands were computed with, and its standard deviation, m/N."""
    strong = np.abs(commands.force) >= np.median(np.abs(commands.force))
    strong &= commands.force != 0.0
    if not strong.any():
        return float("nan"), float("inf")
    part = commands.rows(strong)
    rough = float(np.median((part.u_d - part.x1) / part.force))
    close = np.abs(commands.error(rough)) <= ROUGHLY_RIGHT_RATIO * RIGHT_COMMAND_RMS_SHARE * commands.size
    best = commands.rows(close) if close.any() else part
    power = float(best.force @ best.force)
    value = float(best.force @ (best.u_d - best.x1)) / power
    spread = float(np.sqrt(np.mean(best.error(value) ** 2) / power))
    return value, max(spread, 1e-9 * abs(value))


def affine(commands: Commands) -> tuple[Floats, float]:
    """Gains of x1 and F_d and a constant that fit the commands best, and the rms that is left, m."""
    basis = np.column_stack([commands.x1, commands.force, np.ones(commands.u_d.size)])
    gains = np.asarray(np.linalg.lstsq(basis, commands.u_d, rcond=None)[0], dtype=float)
    return gains, float(np.sqrt(np.mean((commands.u_d - basis @ gains) ** 2)))


def energy(recording: Recording, spec: Spec, commands: Commands, error: Floats, actuator: int) -> float:
    """Work on the plant of the force that an error of the command makes, J; NaN: no velocity is recorded."""
    timing = spec.loop().timing
    at = recording.plant.stamp_ns - recording.start_ns
    force = spec.k_tot[actuator] * delayed(commands.time, error[:, None], timing.ns("tau4"), at)[:, 0]
    v1 = recording.plant.columns("velocity", [spec.loop().interface.plant_dof[actuator]])[:, 0]
    return float(np.sum((force * v1)[:-1] * np.diff(at)) / NS)
