"""`simulate`: from a spec to a trajectory."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from rthm_core.clock import to_ns
from rthm_core.compensators import first_parts
from rthm_core.compiled import Floats
from rthm_core.controller import controller
from rthm_core.engine.coupled.run import simulate_coupled
from rthm_core.engine.curved.run import curved_blocks
from rthm_core.engine.general.ledger import ledger
from rthm_core.engine.general.loop import Loop, rings, run
from rthm_core.engine.linear.blocks import CHUNK_NS, Rows, joined
from rthm_core.engine.linear.run import linear_blocks
from rthm_core.engine.trajectory import Trajectory, of_columns, of_rows
from rthm_core.errors import InputError
from rthm_core.numerical import numerical
from rthm_core.physical.side import build
from rthm_core.schedule import Schedule
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
        Whether the works are counted.

    Raises
    ------
    InputError
        When duration or sample is not a positive number, or `system` is unknown.
    """
    step = checked_step(spec, duration, sample, system)
    if system != "hybrid" or not spec.is_loop:
        return simulate_coupled(spec, to_ns(duration), step, system, energies=energies)
    rows = _fast_rows(spec, to_ns(duration), step, energies=energies)
    if rows is not None:
        return of_rows(spec, rows, step)
    return simulate_any(spec, to_ns(duration), step, energies=energies)


def simulate_blocks(
    spec: Spec, duration: float, sample: float | None = None, *, energies: bool = True
) -> Iterator[Trajectory]:
    """Simulate a loop exactly, a block of some seconds after the other, in bounded memory.

    Parameters and errors are those of `simulate`. The blocks joined are its trajectory, and none is empty.
    """
    blocks = _all_blocks(spec, duration, sample, energies=energies)
    return (block for block in blocks if block.t.size)


def _all_blocks(spec: Spec, duration: float, sample: float | None, *, energies: bool) -> Iterator[Trajectory]:
    """Blocks of rows; one that is shorter than the distance of the rows may have none."""
    step, end = checked_step(spec, duration, sample, "hybrid"), to_ns(duration)
    n1, n2, m = len(spec.plant.dofs), len(spec.loop().numerical.dofs), len(spec.k_tot)
    blocks = fast_blocks(spec, end, step, energies=energies)
    first_row = 0
    if blocks is not None:
        for rows in blocks:
            yield of_rows(spec, rows, step, first_row)
            first_row += rows.plant.shape[0]
        return
    loop = _loop(spec, energies=energies)
    for block in _chunks(spec, loop, end, step, 2 * n1 + 2 * n2 + 2 * m + 7):
        yield of_columns(block, step, n1, n2, m, energies=energies, first_row=first_row)
        first_row += block.shape[0]


def fast_blocks(
    spec: Spec, end: int, step: int, *, energies: bool, span: int = CHUNK_NS
) -> Iterator[Rows] | None:
    """Rows of a loop by the kernel of linear loops or by that of laws on the plant; None if neither fits."""
    blocks = linear_blocks(spec, end, step, energies=energies, span=span)
    return curved_blocks(spec, end, step, energies=energies, span=span) if blocks is None else blocks


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
) -> Trajectory:
    """Simulate a loop of any kind up to `end`, with a row every `step` (ns)."""
    loop = _loop(spec, energies=energies)
    n1, n2, m = loop.physical.model.n, loop.numerical.n, loop.physical.model.m
    rows = list(_chunks(spec, loop, end, step, 2 * n1 + 2 * n2 + 2 * m + 7))
    return of_columns(np.concatenate(rows), step, n1, n2, m, energies=energies)


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
    default = spec.timing.td1 if spec.timing is not None else 0.001
    value = default if sample is None else sample
    if not (np.isfinite(value) and to_ns(value) > 0):
        raise InputError(
            f"sample {value!r} is not allowed, it must be at least one nanosecond; give a "
            f"positive number of seconds."
        )
    return to_ns(value)


def _loop(spec: Spec, *, energies: bool) -> Loop:
    """Loop at the start of a test."""
    physical, number, control = build(spec), numerical(as_built(spec, "numerical")), controller(spec)
    sides, schedule, m = interface(spec), Schedule(spec), len(spec.k_tot)
    x1 = np.array(spec.plant.initial_position)[sides.plant]
    v1 = np.array(spec.plant.initial_velocity)[sides.plant]
    links = schedule.links
    reach = max(links["tau1"].reach_ns, links["tau2"].reach_ns) + 2 * max(schedule.td2, schedule.td3)
    lost = 220 if any(link.loss for link in links.values()) else 0
    ring = rings(
        reach // schedule.td1 + 8 + lost,
        (links["tau3"].reach_ns + max(schedule.td4, schedule.td3)) // schedule.td2 + 8 + lost,
        2
        * (links["tau4"].reach_ns + schedule.motor_delay)
        // min(schedule.td2, schedule.td3, schedule.td4 or schedule.td3)
        + 16
        + 2 * lost,
        m,
        np.concatenate([x1, v1]).astype(float),
        control.force[0].copy(),
    )
    book = ledger(spec, physical, number, *first_parts(spec), on=energies)
    return Loop(physical, number, control, book, ring, schedule.td1, schedule.td2)


def _chunks(spec: Spec, loop: Loop, end: int, step: int, width: int) -> Iterator[Floats]:
    """Rows of the trajectory, a span of time at once; the row at `end` sees everything that happens then."""
    schedule = Schedule(spec)
    last_row = end // step
    begin = 0
    while begin <= end:
        until = min(begin + CHUNK_NS, end + 1)
        first_row, stop_row = -(-begin // step), -(-until // step)
        out = np.zeros((min(stop_row, last_row + 1) - first_row, width))
        run(loop, schedule.events(begin, until, step), out, first_row)
        yield out
        begin = until
