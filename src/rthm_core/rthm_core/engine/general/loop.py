"""The compiled loop: one pass over the schedule's events."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, called, compiled_in_place, copy_into, plainly
from rthm_core.controller import ControllerState, control, latch_force, latch_state
from rthm_core.energy import total_energy
from rthm_core.engine.general.ledger import Ledger, advance_counting
from rthm_core.lent import lent
from rthm_core.numerical import Numerical, advance_numerical, interface_force
from rthm_core.physical.advance import Physical, advance_physical, present_force, set_command
from rthm_core.physical.laws import DOF
from rthm_core.physical.sensors import measured
from rthm_core.schedule import COMMAND, MOTOR, OUTPUT, REFERENCE, SAMPLE, Events


class Rings(NamedTuple):
    """What is under way in the links: the latest samples, references and commands, each at its number modulo
    the length of the ring.

    A command is a row [u_fx, u_ff], and is found by the instant at which it was given.
    """

    sample: Floats
    reference: Floats
    command: Floats
    command_time: Integers
    newest_command: Integers
    first_sample: Floats
    first_reference: Floats
    sum: Floats


class Loop(NamedTuple):
    """Everything the compiled loop changes or needs."""

    physical: Physical
    numerical: Numerical
    controller: ControllerState
    ledger: Ledger
    rings: Rings
    td1: int
    td2: int


@called
def _sample(loop, t, number):  # type: ignore[no-untyped-def]
    """Measure the plant's motion at the interface."""
    model, y = loop.physical.model, loop.physical.state.y
    row = loop.rings.sample[number % loop.rings.sample.shape[0]]
    for a in range(model.m):
        dof = model.wires.numbers[a, DOF]
        row[a] = measured(model.sensors, dof, y[dof], y, t)
        row[model.m + a] = measured(model.sensors, model.n + dof, y[model.n + dof], y, t)


@called
def _reference(loop, number, state):  # type: ignore[no-untyped-def]
    """Tick of the numerical substructure: latch the plant's motion and give F_d."""
    samples = loop.rings.sample
    copy_into(
        loop.numerical.held, samples[state % samples.shape[0]] if state >= 0 else loop.rings.first_sample
    )
    interface_force(
        loop.numerical, loop.numerical.held, loop.rings.reference[number % loop.rings.reference.shape[0]]
    )


@called
def _command(loop, t, state, reference):  # type: ignore[no-untyped-def]
    """Update of the controller: latch what has arrived and give u_d in its two parts."""
    rings, m = loop.rings, loop.physical.model.m
    if state >= 0:
        sample = rings.sample[state % rings.sample.shape[0]]
        latch_state(loop.controller, state * loop.td1, sample[:m], sample[m:])
    if reference >= 0:
        latch_force(
            loop.controller, reference * loop.td2, rings.reference[reference % rings.reference.shape[0]]
        )
    slot = (rings.newest_command[0] + 1) % rings.command_time.size
    rings.newest_command[0] = slot
    rings.command_time[slot] = t
    control(loop.controller, t, rings.command[slot, :m], rings.command[slot, m:])


@called
def _motor(loop, sent):  # type: ignore[no-untyped-def]
    """The command given at `sent` becomes the input of the motors."""
    rings, m = loop.rings, loop.physical.model.m
    slot = rings.newest_command[0]
    for _ in range(rings.command_time.size):
        if rings.command_time[slot] == sent:
            break
        slot = slot - 1 if slot > 0 else rings.command_time.size - 1
    for i in range(m):
        loop.ledger.fx[i], loop.ledger.ff[i] = rings.command[slot, i], rings.command[slot, m + i]
        rings.sum[i] = loop.ledger.fx[i] + loop.ledger.ff[i]
    set_command(loop.physical, rings.sum)


@called
def _output(loop, row):  # type: ignore[no-untyped-def]
    """Write true motion, forces and energies: x1, v1, x2, v2, F_d in use, F, work of six terms, E_total."""
    model, y1, y2 = loop.physical.model, loop.physical.state.y, loop.numerical.y
    n1, n2, m = model.n, loop.numerical.n, model.m
    for i in range(2 * n1):
        row[i] = y1[i]
    copy_into(row[2 * n1 : 2 * n1 + 2 * n2], y2)
    at = 2 * n1 + 2 * n2
    copy_into(row[at : at + m], loop.controller.force[0])
    present_force(loop.physical, row[at + m :])
    at += 2 * m
    copy_into(row[at : at + 6], loop.ledger.work)
    row[at + 6] = total_energy(loop.ledger.bodies, y1[:n1], y1[n1 : 2 * n1], y2[:n2], y2[n2:])


@plainly
@compiled_in_place
def run(loop: Loop, events: Events, out: Floats, first_row: int) -> None:
    """Execute `events` in order; row r of the outputs goes to ``out[r - first_row]``."""
    loop, counting = lent(loop), loop.ledger.on
    for e in range(events.time.size):
        t, what = events.time[e], events.what[e]
        if counting and what != COMMAND:
            advance_counting(loop.physical, loop.numerical, loop.ledger, t)
        if not counting and (what in (SAMPLE, MOTOR, OUTPUT)):
            advance_physical(loop.physical, t)
        if not counting and (what in (REFERENCE, OUTPUT)):
            advance_numerical(loop.numerical, t)
        if what == SAMPLE:
            _sample(loop, t, events.index[e])
        elif what == REFERENCE:
            _reference(loop, events.index[e], events.state[e])
        elif what == COMMAND:
            _command(loop, t, events.state[e], events.reference[e])
        elif what == MOTOR:
            _motor(loop, events.index[e])
        elif what == OUTPUT:
            _output(loop, out[events.index[e] - first_row])


def rings(
    samples: int, references: int, commands: int, m: int, first_sample: Floats, first_reference: Floats
) -> Rings:
    """Empty rings of the given lengths for `m` actuators."""
    return Rings(
        np.zeros((samples, 2 * m)),
        np.zeros((references, m)),
        np.zeros((commands, 2 * m)),
        np.full(commands, -1, dtype=np.int64),
        np.zeros(1, dtype=np.int64),
        first_sample,
        first_reference,
        np.zeros(m),
    )
