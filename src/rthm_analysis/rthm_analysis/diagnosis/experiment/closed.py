"""The loop closed within the mechanics of a replay, so that a test that nobody has run can be predicted.

A planned test has no recorded commands: what controller and numerical substructure would do is part of the
prediction. Both are linear, and so are links that delay; a delay of some milliseconds in motions of some
radians per second is a filter of first order (Pade) to 1e-4 of the motion. So the whole loop fits into the
linear part of `Mechanics`, beside the laws of plant and wires.

Why not the exact engine: its kernels for laws that are not linear take 16 to 25 s to compile, and no
diagnosis may wait for that; once compiled they need 9 ms for a plant with dry friction over 30 s, and 46 ms
with a hardening wire. The kernel of the replay has been compiled by whatever was diagnosed, and needs 1 ms.
It is off by some thousandths of the motion, for all hypotheses alike: predicted differences agree with those
of the exact engine to some per cent.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.experiment import LIGHT_MASS_SHARE, STRAIGHT_DELAY_RADIANS
from rthm_analysis.diagnosis.experiment.delays import Delays, delays_of
from rthm_analysis.diagnosis.replay.mechanics import Mechanics, fastest, mechanics
from rthm_core.substructure import as_built, free_dynamics, interface, natural_frequencies, substructure

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


FILTERS_PER_ACTUATOR = 6
"""Filters of each actuator: x1 and F_d at the motor, x1 and v1 in the reference, both in what it feels."""


def closed_loop(spec: Spec) -> Mechanics:
    """Mechanics in which the motors follow the motion; the plant's own for a plant alone.

    Returns
    -------
    Mechanics
        Its states are those of `mechanics`, positions and velocities of the numerical dofs, and filters.
        The first motor's column of `mechanics` is free for a load on a numerical dof (`loaded`); the motors
        need no input.
    """
    opened = mechanics(spec)
    return _Closing(spec, opened).closed() if spec.is_loop else opened


def loaded(closed: Mechanics, spec: Spec, dof: str | None) -> Mechanics:
    """The same with the first motor's input as a force, N, on a dof of the numerical substructure."""
    if dof is None or not spec.is_loop:
        return closed
    two = substructure(as_built(spec, "numerical").loop().numerical)
    columns, place = closed.mechanics.copy(), spec.loop().numerical.dofs.index(dof)
    first = _own_states(spec, closed) + two.dofs
    columns[first : first + two.dofs, closed.initial.size] = np.linalg.inv(two.mass)[:, place]
    return closed._replace(mechanics=columns)


def fastest_motion(spec: Spec) -> float:
    """Largest rate, rad/s, of plant, wires and numerical substructure."""
    own = fastest(mechanics(spec), spec)
    if not spec.is_loop:
        return own
    two = substructure(as_built(spec, "numerical").loop().numerical)
    swings, grows = (natural_frequencies(two.mass, sign * two.stiffness)[-1] for sign in (1.0, -1.0))
    return max(own, float(swings), float(grows))


def _own_states(spec: Spec, closed: Mechanics) -> int:
    """States of plant and wires within a closed loop."""
    loop = spec.loop()
    return closed.initial.size - 2 * loop.numerical.n - FILTERS_PER_ACTUATOR * len(loop.actuator.names)


class _Closing:
    """A loop being closed; a signal is a row of weights over all states."""

    def __init__(self, spec: Spec, opened: Mechanics) -> None:
        self.spec, self.opened, self.sides = spec, opened, interface(as_built(spec, "numerical"))
        self.n, self.m = opened.n, opened.m
        self.two = substructure(as_built(spec, "numerical").loop().numerical)
        self.own = opened.initial.size
        self.size = self.own + 2 * self.two.dofs + FILTERS_PER_ACTUATOR * self.m
        self.a, self.initial = np.zeros((self.size, self.size)), np.zeros(self.size)
        self.next = self.own + 2 * self.two.dofs
        self.delays, self.fastest = delays_of(spec), fastest_motion(spec)

    def closed(self) -> Mechanics:
        o = self.opened
        self.a[: self.own, : self.own], self.initial[: self.own] = o.a, o.initial
        self._numerical()
        commands = np.array([self._command(i, self.delays) for i in range(self.m)])
        self.a[: self.own] += o.by_motors @ commands
        inputs = np.zeros((self.size, o.mechanics.shape[1] - self.own))
        inputs[: self.own, self.m :] = o.mechanics[:, self.own + self.m :]
        drive, force = (self._over(rows, commands) for rows in (o.wires.drive, o.wires.force))
        return o._replace(
            mechanics=np.hstack([self.a, inputs]),
            wires=o.wires._replace(drive=drive, force=force),
            initial=self.initial,
        )

    def _over(self, rows: Floats, commands: Floats) -> Floats:
        """Rows (m, own + m) over own states and motors as rows (m, size + m) over all states."""
        wide = np.zeros((self.m, self.size + self.m))
        wide[:, : self.own] = rows[:, : self.own]
        wide[:, : self.size] += rows[:, self.own :] @ commands
        return wide

    def _unit(self, state: int) -> Floats:
        row = np.zeros(self.size)
        row[state] = 1.0
        return row

    def _numerical(self) -> None:
        """Free motion of the numerical substructure; the interface adds to it."""
        two = self.two
        motion = slice(self.own, self.own + 2 * two.dofs)
        self.a[motion, motion], _ = free_dynamics(two.mass, two.damping, two.stiffness)
        self.initial[motion] = [*two.position, *two.velocity]

    def _command(self, actuator: int, late: Delays) -> Floats:
        """Motor position of an actuator, and the pull of its interface at the numerical side."""
        dof, first = int(self.sides.plant[actuator]), self.own + int(self.sides.numerical[actuator])
        x1, v1 = self._unit(dof), self._unit(self.n + dof)
        x2, v2 = self._unit(first), self._unit(first + self.two.dofs)
        held = self._late(x1, v1, late.held), self._late_rate(actuator, v1, late.held)
        pull = -self._interface(actuator, *held, x2, v2)
        inverse = np.linalg.inv(self.two.mass)[:, self.sides.numerical[actuator]]
        rows = slice(self.own + self.two.dofs, self.own + 2 * self.two.dofs)
        self.a[rows] += np.outer(inverse, pull)
        seen, seen_rate = self._late(x1, v1, late.seen), self._late_rate(actuator, v1, late.seen)
        reference = self._interface(actuator, seen, seen_rate, x2, v2)
        rate = -self.sides.stiffness[actuator] * (seen_rate - v2)
        compliance = 1.0 / as_built(self.spec, "controller").k_tot[actuator]
        command = self._late(x1, v1, late.position)
        return np.asarray(command + compliance * self._late(reference, rate, late.reference))

    def _interface(self, i: int, x1: Floats, v1: Floats, x2: Floats, v2: Floats) -> Floats:
        force = -self.sides.damping[i] * (v1 - v2) - self.sides.stiffness[i] * (x1 - x2)
        return np.asarray(force)

    def _late(self, signal: Floats, rate: Floats, delay: float) -> Floats:
        """A signal, whose rate is known, as it was `delay` s ago."""
        straight = delay * self.fastest < STRAIGHT_DELAY_RADIANS
        return np.asarray(signal - delay * rate) if straight else self._filtered(signal, delay)

    def _late_rate(self, actuator: int, rate: Floats, delay: float) -> Floats:
        """Velocity of the plant, as the interface's damper felt it `delay` s ago."""
        inertia = self.sides.damping[actuator] * delay
        light = inertia < LIGHT_MASS_SHARE * min(
            np.diag(self.two.mass).min(), 1.0 / np.diag(self.opened.inverse_mass).max()
        )
        return rate if light else self._filtered(rate, delay)

    def _filtered(self, signal: Floats, delay: float) -> Floats:
        state, self.next = self.next, self.next + 1
        self.a[state] += (2.0 / delay) * (2.0 * signal - self._unit(state))
        self.initial[state] = 2.0 * signal @ self.initial
        return np.asarray(self._unit(state) - signal)
