"""`simulate`: from a spec to a trajectory."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from rthm_core.clock import to_ns
from rthm_core.compensation import first_parts
from rthm_core.compiled import Floats
from rthm_core.controller import controller
from rthm_core.engine.coupled.run import simulate_coupled
from rthm_core.engine.general.ledger import ledger
from rthm_core.engine.general.loop import Loop, rings, run
from rthm_core.engine.linear.blocks import CHUNK_NS, Rows, joined
from rthm_core.engine.linear.run import linear_blocks
from rthm_core.engine.nonlinear.run import nonlinear_blocks
from rthm_core.engine.trajectory import Trajectory, of_columns, of_rows
from rthm_core.errors import InputError
from rthm_core.numerical import numerical
from rthm_core.physical.side import build
from rthm_core.schedule import Schedule
from rthm_core.spec.masses import heavy, mass_at
from rthm_core.substructure import as_built, interface

if TYPE_CHECKING:
    from rthm_core.spec import Spec

SYSTEMS = ("hybrid", "ideal", "taylor")


def simulate(
    spec: Spec,
    duration: float,
    sample: float | None = None,
    system: str = "hybrid",
    *,
    energies: bool = True,
    schedule: Schedule | None = None,
) -> Trajectory:
    """Simulate a test exactly.

    Parameters
    ----------
    spec : Spec
        Loop, or plant alone.
    duration : float
        Length in s; the last row is at `duration`.
    sample : float, optional
        Distance of the rows in s; Td1 (or 1 ms for a plant alone) when absent.
    system : {"hybrid", "ideal", "taylor"}
        The loop with its delays; the same without delays, holds and actuator; or the first-order
        approximation (25) and (26).
    energies : bool
        Whether the work is counted.
    schedule : Schedule, optional
        When which sample is used in the loop, as it was in a recorded test; by the spec when absent. Its
        clocks are those of the spec.

    Raises
    ------
    InputError
        When duration or sample is not a positive number, or `system` is unknown.
    """
    step = checked_step(spec, duration, sample, system)
    if system != "hybrid" or not spec.is_loop:
        return simulate_coupled(spec, to_ns(duration), step, system, energies=energies)
    rows = None if schedule else _fast_rows(spec, to_ns(duration), step, energies=energies)
    if rows is not None:
        return of_rows(spec, rows, step)
    return simulate_any(spec, to_ns(duration), step, energies=energies, schedule=schedule)


def simulate_blocks(
    spec: Spec,
    duration: float,
    sample: float | None = None,
    *,
    energies: bool = True,
    schedule: Schedule | None = None,
) -> Iterator[Trajectory]:
    """Simulate a loop exactly, a block of some seconds after the other, in bounded memory.

    Parameters and errors are those of `simulate`. The blocks joined are its trajectory, and none is empty.
    """
    step, end = checked_step(spec, duration, sample), to_ns(duration)
    fast = None if schedule else fast_blocks(spec, end, step, energies=energies)
    blocks = (
        _blocks_of_any(spec, end, step, schedule or Schedule(spec), energies=energies)
        if fast is None
        else _blocks_of_rows(spec, fast, step)
    )
    return (block for block in blocks if block.t.size)


def _blocks_of_rows(spec: Spec, blocks: Iterator[Rows], step: int) -> Iterator[Trajectory]:
    """Blocks of a fast kernel; one that is shorter than the distance of the rows may have none."""
    first_row = 0
    for rows in blocks:
        yield of_rows(spec, rows, step, first_row)
        first_row += rows.plant.shape[0]


def _blocks_of_any(
    spec: Spec, end: int, step: int, schedule: Schedule, *, energies: bool
) -> Iterator[Trajectory]:
    """Blocks of a loop of any kind, of which some may have no row either."""
    first_row = 0
    for columns in _chunks(spec, end, step, schedule, energies=energies):
        yield of_columns(columns, step, *_sizes(spec), energies=energies, first_row=first_row)
        first_row += columns.shape[0]


def fast_blocks(
    spec: Spec, end: int, step: int, *, energies: bool, span: int = CHUNK_NS
) -> Iterator[Rows] | None:
    """Rows of a loop by the kernel of linear loops or by that of laws on the plant; None if neither fits."""
    blocks = linear_blocks(spec, end, step, energies=energies, span=span)
    return nonlinear_blocks(spec, end, step, energies=energies, span=span) if blocks is None else blocks


def _fast_rows(spec: Spec, end: int, step: int, *, energies: bool) -> Rows | None:
    blocks = fast_blocks(spec, end, step, energies=energies, span=end + 1)
    if blocks is None:
        return None
    return Rows(*joined(list(blocks)))


def simulate_any(
    spec: Spec,
    end: int,
    step: int,
    *,
    energies: bool = True,
    schedule: Schedule | None = None,
) -> Trajectory:
    """Simulate a loop of any kind up to `end`, with a row every `step` (ns)."""
    columns = list(_chunks(spec, end, step, schedule or Schedule(spec), energies=energies))
    return of_columns(np.concatenate(columns), step, *_sizes(spec), energies=energies)


def checked_step(spec: Spec, duration: float, sample: float | None, system: str = "hybrid") -> int:
    """Distance of the rows in ns; refuses what `simulate` says it does."""
    if system not in SYSTEMS:
        raise InputError(
            f"system {system!r} is not known, allowed is one of {', '.join(SYSTEMS)}; choose one of them."
        )
    if not (np.isfinite(duration) and duration > 0.0):
        raise InputError(
            f"duration {duration!r} is not allowed, it must be a positive number of seconds; "
            f"give one above zero."
        )
    if heavy(spec) and np.linalg.eigvalsh(mass_at(spec, duration))[0] <= 0.0:
        raise InputError(
            f"duration {duration:g} s is not allowed, it must end before effects have taken all mass away; "
            "simulate less, or let less mass leave."
        )
    default = spec.timing.td1 if spec.timing is not None else 0.001
    value = default if sample is None else sample
    if not (np.isfinite(value) and to_ns(value) > 0):
        raise InputError(
            f"sample {value!r} is not allowed, it must be at least one nanosecond; give a "
            f"positive number of seconds."
        )
    return to_ns(value)


def _loop(spec: Spec, schedule: Schedule, *, energies: bool) -> Loop:
    """Loop at the start of a test."""
    physical, number, control = build(spec), numerical(as_built(spec, "numerical")), controller(spec)
    sides, m = interface(spec), len(spec.k_tot)
    x1 = np.array(spec.plant.initial_position)[sides.plant]
    v1 = np.array(spec.plant.initial_velocity)[sides.plant]
    first_sample = np.concatenate([x1, v1]).astype(float)
    ring = rings(*schedule.depth, m, first_sample, control.force[0].copy())
    book = ledger(spec, physical, number, *first_parts(spec), on=energies)
    return Loop(physical, number, control, book, ring, schedule.td1, schedule.td2)


def _sizes(spec: Spec) -> tuple[int, int, int]:
    """Dofs of the plant and of the numerical substructure, and actuators."""
    return len(spec.plant.dofs), len(spec.loop().numerical.dofs), len(spec.k_tot)


def _chunks(spec: Spec, end: int, step: int, schedule: Schedule, *, energies: bool) -> Iterator[Floats]:
    """Rows of the trajectory, a span of time at once; the row at `end` sees everything that happens then."""
    loop, (n1, n2, m) = _loop(spec, schedule, energies=energies), _sizes(spec)
    last_row, begin = end // step, 0
    while begin <= end:
        until = min(begin + CHUNK_NS, end + 1)
        first_row, stop_row = -(-begin // step), -(-until // step)
        out = np.zeros((min(stop_row, last_row + 1) - first_row, 2 * n1 + 2 * n2 + 2 * m + 7))
        run(loop, schedule.events(begin, until, step), out, first_row)
        yield out
        begin = until
