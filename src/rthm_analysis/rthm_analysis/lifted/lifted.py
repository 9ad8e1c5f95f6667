"""A loop lifted to one hyperperiod: its state at the cut, and the matrix that takes it to the next one."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from rthm_analysis.lifted.cycle import FORCE, POSITION, VELOCITY, Cycle
from rthm_analysis.lifted.matrices import LinearLoop
from rthm_analysis.lifted.predictor import weights
from rthm_analysis.lifted.steps import steps
from rthm_analysis.lifted.walk import Columns, Forcing, Plan, plan, walk
from rthm_core.compiled import Floats


@dataclass(frozen=True)
class Lifted:
    """A linear loop along a cycle.

    `nominal_unit` is the unit in s of the cycle's times before it was scaled (`Cycle.scaled`).
    The lifted state is ``[p, z2, u, everything remembered at the cut]``; u, the input of the motors, is
    left out where a command arrives at the cut itself.
    """

    loop: LinearLoop
    cycle: Cycle
    nominal_unit: float = 0.0
    plan: Plan = field(init=False)

    def __post_init__(self) -> None:
        loop, unit = self.loop, self.cycle.unit
        first, second = (np.asarray(part * unit, dtype=float) for part in self.cycle.intervals)
        every = (steps(loop.a1, loop.b1, first), steps(loop.a2, loop.b2, second))
        object.__setattr__(self, "plan", plan(loop, self.cycle, *every, self._weights()))

    def _weights(self) -> Floats:
        m, history = self.loop.actuators, self.cycle.past.shape[2]
        if self.loop.predictor is None:
            return np.zeros((0, 3, history, m))
        parts = weights(self.loop.predictor, self.cycle, self.nominal_unit or self.cycle.unit)
        return np.ascontiguousarray(parts[..., 0] + self.loop.flexibility * parts[..., 1])

    @property
    def moving(self) -> int:
        """Number of rows of the lifted state that are motion: physical and numerical states."""
        return int(self.loop.a1.shape[0] + self.loop.a2.shape[0])

    @property
    def size(self) -> int:
        """Number of rows of the lifted state."""
        return self.moving + self.loop.actuators * (self.cycle.kept.size + self.cycle.motor_held)

    def columns(self, states: Floats) -> Columns:
        """Lifted states (size, L) spread out for a walk."""
        loop, m, count = self.loop, self.loop.actuators, states.shape[1]
        n1, held = loop.a1.shape[0], self.moving + m * self.cycle.motor_held
        store = np.zeros((self.cycle.places, m, count), dtype=states.dtype)
        store[: self.cycle.kept.size] = states[held:].reshape(-1, m, count)
        u = states[self.moving : held] if self.cycle.motor_held else np.zeros((m, count), dtype=states.dtype)
        return Columns(
            states[:n1].copy(),
            states[n1 : self.moving].copy(),
            u.copy(),
            np.zeros((2 * m, count), dtype=states.dtype),
            store,
            np.empty((max(n1, self.moving - n1), count), dtype=states.dtype),
        )

    def states(self, columns: Columns) -> Floats:
        """Lifted states (size, L) at the end of a walk."""
        u = columns.u if self.cycle.motor_held else columns.u[:0]
        kept = columns.store[self.cycle.kept].reshape(-1, columns.p.shape[1])
        return np.asarray(np.concatenate([columns.p, columns.z, u, kept]))

    def advanced(self, states: Floats, forcing: Forcing | None = None) -> Floats:
        """Lifted states (size, L) one hyperperiod later."""
        columns = self.columns(np.ascontiguousarray(states))
        walk(self.plan, columns, forcing or _no_forcing(columns))
        return self.states(columns)

    def monodromy(self) -> Floats:
        """Matrix (size, size) that takes the lifted state over one hyperperiod."""
        return self.advanced(np.eye(self.size))

    def at_rest_before(self, p: Floats, z: Floats) -> Floats:
        """Lifted state (size,) of a loop in steady state at its present values.

        The motors' input in force and the commands under way are those that follow from `p` and `z`.
        """
        loop, m = self.loop, self.loop.actuators
        held = loop.sampled @ p
        force = loop.force_held @ held + loop.force_state @ z
        command = held[:m] + loop.flexibility * force
        values = {POSITION: held[:m], VELOCITY: held[m:], FORCE: force}
        remembered = [values.get(int(kind), command) for kind in self.cycle.kind]
        u = [command] if self.cycle.motor_held else []
        return np.concatenate([p, z, *u, *remembered])


def _no_forcing(columns: Columns) -> Forcing:
    m, count = columns.u.shape
    none = np.zeros((0, 2 * m, count), dtype=columns.p.dtype)
    return Forcing(none, none[:, :m], none)
