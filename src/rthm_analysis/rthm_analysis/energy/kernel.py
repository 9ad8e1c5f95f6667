"""The compiled pass over recorded samples: the engine's own energy balance, held to what was measured.

    recorded   command   tick    sample             command   sample
    model      u_d       z2      balance, then z1     u_d       balance, then z1

Between two samples the model of the loop moves as in the exact engine, driven by the recorded commands, and
the engine's ledger counts the work. At every sample of the plant the model is set to the measured motion, at
every tick of the numerical substructure to the recorded state. What such a step changes in energy is the work
of no term: it is what the balance error shows.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats, Integers, called, compiled_in_place, copy_into
from rthm_core.energy import total_energy
from rthm_core.engine.general.ledger import Ledger, advance_counting
from rthm_core.lent import lent
from rthm_core.numerical import Numerical, begin_numerical
from rthm_core.physical.advance import Physical, present_rate, set_command
from rthm_core.physical.laws import FRICTION, PARTITION, POSITION, VELOCITY
from rthm_core.physical.switching import motion_of, stop

COMMAND, TICK, SAMPLE = range(3)
"""What is recorded, in the order in which it takes place at one instant."""

TERM_COUNT = 6
"""Number of terms of work that the ledger counts (``rthm_core.energy.TERMS``)."""


class Balance(NamedTuple):
    """Model of the loop and its ledger.

    Attributes
    ----------
    first_load : int
        The measured loads are the model's loads from this one on.
    quiet : float
        Speed below which a measured dof may as well be at rest, m/s.
    """

    physical: Physical
    numerical: Numerical
    ledger: Ledger
    first_load: int
    quiet: float


class Events(NamedTuple):
    """Recorded samples in time order, the last one a sample of the plant.

    Attributes
    ----------
    time, what, index : (e,) arrays
        ns since the start of the test; COMMAND, TICK or SAMPLE; row in the array of that kind.
    command : (c, 2 m) array
        Both parts of u_d at their use, position cancellation and F_d / k_tot, in m.
    tick : (k, 2 n2) array
        x2 and v2.
    held : (k, 2 m) array
        Motion [x1, v1] of the plant that the numerical side holds from the tick on; NaN: the one before.
    sample : (s, 2 n1) array
        Measured x1 and v1.
    load : (s, n1) array
        Measured load on the plant beyond the one in the spec, until this sample.
    """

    time: Integers
    what: Integers
    index: Integers  # type: ignore[assignment]
    command: Floats
    tick: Floats
    held: Floats
    sample: Floats
    load: Floats


def row_width(balance: Balance) -> int:
    """Numbers that are written at a sample: work, E_total, a1, v2 and a2."""
    return int(TERM_COUNT + 1 + balance.physical.model.n + 2 * balance.numerical.n)


@called
def _bear(balance, load):  # type: ignore[no-untyped-def]
    """Put the measured loads on the model."""
    for i in range(load.size):
        balance.physical.model.loads.constant[balance.first_load + i] = load[i]


@called
def _given(balance, command):  # type: ignore[no-untyped-def]
    """Give the motors a command, and the ledger its two parts."""
    fx, ff, both = balance.ledger.fx, balance.ledger.ff, balance.ledger.parts[0]
    for i in range(fx.size):
        fx[i], ff[i] = command[i], command[fx.size + i]
        both[i] = fx[i] + ff[i]
    set_command(balance.physical, both)


@called
def _latched(balance, tick, held):  # type: ignore[no-untyped-def]
    """Set the numerical side to its recorded state, and let it hold what it latched."""
    copy_into(balance.numerical.y, tick)
    for i in range(held.size):
        if not np.isnan(held[i]):
            balance.numerical.held[i] = held[i]


@called
def _moved(balance, laws, sample):  # type: ignore[no-untyped-def]
    """Set the plant to its measured motion, and every law to the mode in which it then is.

    A dof that the model holds by friction and that is measured as slow as noise makes a resting one stays at
    rest.
    """
    state, n = balance.physical.state, balance.physical.model.n
    for j in range(sample.size):
        state.y[j] = sample[j]
    if laws is not None:
        for row in range(laws.numbers.shape[0]):
            partition = laws.numbers[row, PARTITION]
            x, v = motion_of(laws, n, row, state.y)
            if partition == POSITION:
                mode = 0
                for k in range(laws.thresholds.shape[1]):
                    mode += laws.thresholds[row, k] < x
                state.modes[row] = mode
            elif partition == FRICTION and state.modes[row] == 0 and abs(v) <= balance.quiet:
                stop(laws, n, row, state.y)
            elif partition in (VELOCITY, FRICTION):
                state.modes[row] = -1 if v < 0.0 else 1


@called
def _write(balance, dy, row):  # type: ignore[no-untyped-def]
    """Write work, E_total, a1, v2 and a2."""
    physical, numerical, ledger = balance.physical, balance.numerical, balance.ledger
    n1, n2, y1, y2, ab = physical.model.n, numerical.n, physical.state.y, numerical.y, numerical.system.ab
    for term in range(TERM_COUNT):
        row[term] = ledger.work[term]
    row[TERM_COUNT] = total_energy(ledger.bodies, y1[:n1], y1[n1 : 2 * n1], y2[:n2], y2[n2:])
    present_rate(physical, dy)
    for i in range(n1):
        row[TERM_COUNT + 1 + i] = dy[n1 + i]
    begin_numerical(numerical)
    for i in range(n2):
        rate = 0.0
        for j in range(2 * n2):
            rate += ab[n2 + i, j] * y2[j]
        for j in range(numerical.inputs.shape[1]):
            rate += ab[n2 + i, 2 * n2 + j] * numerical.inputs[0, j]
        row[TERM_COUNT + 1 + n1 + i] = y2[n2 + i]
        row[TERM_COUNT + 1 + n1 + n2 + i] = rate


@compiled_in_place
def account(balance: Balance, events: Events, rows: Floats) -> None:
    """Carry the energy balance over `events`; row i of `rows` (s, `row_width`) is written at sample i."""
    balance, dy = lent(balance), balance.ledger.dy
    _bear(balance, events.load[0])
    for e in range(events.time.size):
        i = events.index[e]
        advance_counting(balance.physical, balance.numerical, balance.ledger, events.time[e])
        if events.what[e] == COMMAND:
            _given(balance, events.command[i])
        elif events.what[e] == TICK:
            _latched(balance, events.tick[i], events.held[i])
        else:
            _moved(balance, balance.physical.model.laws, events.sample[i])
            _write(balance, dy, rows[i])
            if i + 1 < events.load.shape[0]:
                _bear(balance, events.load[i + 1])
