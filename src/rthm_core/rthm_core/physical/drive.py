"""Motors: from the commands to the motor positions u, one linear chain per actuator.

``u = h(s) u_d(t - tau4)`` with ``h(s) = 1 / ((1 + s/kv)(1 + s/ka))`` (paper, (1) and (2)), followed by the
elements that effects add. Before the chain stand the effects on the command itself: what is added to it, its
step, its limit and its rate, in this order.
"""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rthm_core.addressed import Call, caller, table_of
from rthm_core.compiled import Floats, Integers, called, compiled_in_place, uncompiled
from rthm_core.effects.laws import MOST_PARAMETERS
from rthm_core.effects.motor import Element, MotorEffect, first_order
from rthm_core.linear import LinearSystem, linear_system
from rthm_core.spec.effect import sizes

if TYPE_CHECKING:
    from rthm_core.effects.declaration import Change
    from rthm_core.spec import Spec


class Shifts(NamedTuple):
    """Positions that motors add to their commands.

    Attributes
    ----------
    numbers : (s, 2) array
        Address of the function, and the actuator.
    parameters : (s, 8) array
        Of the functions.
    """

    numbers: Integers
    parameters: Floats


class Drive(NamedTuple):
    """Motors of all actuators.

    Attributes
    ----------
    system : LinearSystem
        Chain states q (nq,) driven by the commands (m,).
    out : (m, nq + m) array
        ``u = out [q, command]``.
    conditioning : (3, m) array
        Quantisation step (m, 0: none), saturation (m) and rate limit (m/s) of the command (inf: none).
    shifts : Shifts
    """

    system: LinearSystem
    out: Floats
    conditioning: Floats
    shifts: Shifts

    def takes_commands_as(self, other: Drive) -> bool:
        """Whether it makes the same of a command before its chain as another."""
        same = (np.array_equal(a, b) for a, b in zip(self.shifts, other.shifts, strict=True))
        return np.array_equal(self.conditioning, other.conditioning) and all(same)


QUANTUM, LIMIT, RATE = range(3)
"""Rows of ``Drive.conditioning``."""

SHIFT = Call("u, t, p", True)
"""How a position that a motor adds to its command is called."""

_shift = caller(0, SHIFT)


def _chain(spec: Spec, actuator: str, *, effects: bool) -> list[Element]:
    """Elements of one motor in the order in which the command passes them."""
    assert spec.actuator is not None
    chain = [first_order(1.0 / pole) for pole in spec.actuator.motor_poles or ()]
    for one in spec.effects if effects else ():
        if one.actuator == actuator and issubclass(law := one.law, MotorEffect):
            element = law.element(one.numbers)
            chain += [] if element is None else [element]
    return chain


def _conditioning(spec: Spec, changes: Change, absent: float) -> Floats:
    assert spec.actuator is not None
    found = (sizes(spec.effects, "motor", changes, name) for name in spec.actuator.names)
    return np.array([[absent, *values][-1] for values in found])


@cache
def _code_of(law: Any) -> int:
    return table_of([(law.shift, SHIFT)])


def _shifts(spec: Spec, names: tuple[str, ...], *, effects: bool) -> Shifts:
    found = [
        one for one in spec.effects if effects and one.law.changes == "command" and one.actuator in names
    ]
    numbers = np.zeros((len(found), 2), dtype=np.int64)
    parameters = np.zeros((len(found), MOST_PARAMETERS))
    for row, one in enumerate(found):
        law: Any = one.law
        numbers[row] = _code_of(law), names.index(str(one.actuator))
        parameters[row, : len(one.ordered)] = one.ordered
    return Shifts(numbers, parameters)


def drive(spec: Spec, orders: int = 1, *, effects: bool = True, actuators: int | None = None) -> Drive:
    """Motors of a spec, or of its first `actuators`; ``effects=False`` gives the motors that the controller
    believes in, h(s) alone.
    """
    names = spec.actuator.names[:actuators] if spec.actuator else ()
    m = len(names)
    chains = [_chain(spec, name, effects=effects) for name in names]
    nq = sum(element.entry.size for chain in chains for element in chain)
    a, b = np.zeros((nq, nq)), np.zeros((nq, m))
    out, through = np.zeros((m, nq)), np.zeros((m, m))
    at = 0
    for actuator, chain in enumerate(chains):
        from_states, from_command = np.zeros(nq), 1.0
        for dynamics, entry, row in chain:
            span = slice(at, at + entry.size)
            a[span, span] = dynamics
            a[span] += np.outer(entry, from_states)
            b[span, actuator] = entry * from_command
            from_states, from_command = np.zeros(nq), 0.0
            from_states[span] = row
            at += entry.size
        out[actuator] = from_states
        through[actuator, actuator] = from_command
    conditioning = np.array([np.zeros(m), np.full(m, np.inf), np.full(m, np.inf)])
    if m and effects:
        conditioning[QUANTUM] = _conditioning(spec, "step", 0.0)
        conditioning[LIMIT] = _conditioning(spec, "limit", np.inf)
        conditioning[RATE] = _conditioning(spec, "rate", np.inf)
    return Drive(
        linear_system(a, b, orders),
        np.hstack([out, through]),
        conditioning,
        _shifts(spec, names, effects=effects),
    )


def settled(drive: Drive, command: Floats) -> Floats:
    """Chain states (nq,) in steady state under `command` (m,)."""
    if not drive.system.a.size:
        return np.empty(0)
    return np.asarray(np.linalg.solve(drive.system.a, -drive.system.b @ command))


def accepted(drive: Drive, commands: Floats, time: Floats) -> Floats:
    """Commands (c, m) at their times (c,) in s, as the drives take them; a rate limit is still to be
    travelled.
    """
    taken = np.empty_like(commands, dtype=float)
    if time.size == 1 and not drive.shifts.numbers.size:
        uncompiled(conditioned)(drive, commands[0], time[0], taken[0])
        return taken
    _conditioned_all(drive, np.ascontiguousarray(commands, dtype=float), time, taken)
    return taken


@compiled_in_place
def _conditioned_all(drive: Any, commands: Any, time: Any, out: Any) -> None:
    for row in range(time.size):
        conditioned(drive, commands[row], time[row], out[row])


@called
def conditioned(drive, command, t, out):  # type: ignore[no-untyped-def]
    """Write into `out` (m,) what the drives take of a command (m,) at time `t`, in s."""
    for i in range(out.size):
        out[i] = command[i]
    for row in range(drive.shifts.numbers.shape[0]):
        code, i = drive.shifts.numbers[row]
        out[i] += _shift(code, command[i], t, drive.shifts.parameters[row])
    for i in range(out.size):
        quantum, limit = drive.conditioning[QUANTUM, i], drive.conditioning[LIMIT, i]
        value = out[i]
        if quantum > 0.0:
            value = quantum * math.floor(value / quantum + 0.5)
        out[i] = min(max(value, -limit), limit)


@called
def motor_position(drive, q, command, out):  # type: ignore[no-untyped-def]
    """Motor positions u (m,) of chain states `q` under the present command (m,)."""
    nq = q.size
    for i in range(out.size):
        u = 0.0
        for j in range(nq):
            u += drive.out[i, j] * q[j]
        for j in range(out.size):
            u += drive.out[i, nq + j] * command[j]
        out[i] = u


@called
def motor_velocity(drive, q, command, out):  # type: ignore[no-untyped-def]
    """Motor velocities du/dt (m,); the jumps of a motor without dynamics are left out."""
    nq, ab = q.size, drive.system.ab
    for i in range(out.size):
        out[i] = 0.0
        for j in range(nq):
            rate = 0.0
            for k in range(nq):
                rate += ab[j, k] * q[k]
            for k in range(out.size):
                rate += ab[j, nq + k] * command[k]
            out[i] += drive.out[i, j] * rate
