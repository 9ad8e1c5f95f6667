"""From columns to the table of ``plant/state``, in SI, with what is odd about the values."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.exchange.columns import Columns
from rthm_analysis.exchange.mapping import ROLES, USUAL, Signal, Wanted
from rthm_analysis.exchange.stamps import no_column, stamps_of
from rthm_analysis.exchange.units import factor
from rthm_analysis.recording import Table
from rthm_analysis.recording.cdr import FIELDS
from rthm_core.errors import InputError
from rthm_core.spec import Spec
from rthm_core.topics import PLANT_STATE

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers

MOTION = ("position", "velocity", "acceleration")
"""Roles of which one at least has to be there."""

LARGEST = {"m": 50.0, "m/s": 200.0, "m/s^2": 1e4, "N": 1e8, "1": math.inf}
"""Values beyond which a unit is probably another one."""

DISAGREE = 3.0
"""Factor between a signal and the rate of another that no noise makes."""


def plant_tables(columns: Columns, wanted: Wanted, spec: Spec | None) -> tuple[dict[str, Table], list[str]]:
    """Samples of the plant by topic, and remarks on them, one sentence each.

    Raises
    ------
    InputError
        A column is not there or has no numbers, columns have different lengths, a value is infinite, a unit
        is not known, or nothing is said to be a position, a velocity or an acceleration.
    """
    _check_roles(columns, wanted)
    values = {one: _in_si(columns, one, wanted) for one in wanted.signals}
    sizes = {one.column: column.size for one, column in values.items()}
    if len(set(sizes.values())) > 1:
        told = ", ".join(f"{name} {size}" for name, size in sizes.items())
        raise InputError(
            f"{columns.source}: columns have different lengths ({told}); take those of one table."
        )
    stamps, notes = stamps_of(columns, wanted, next(iter(sizes.values())))
    for one, column in values.items():
        notes += _remarks(one, column)
    tables = {
        topic: _table(
            stamps, names, {one: of for one, of in values.items() if ROLES[one.role].topic == topic}
        )
        for topic, names in _names(wanted, spec).items()
    }
    return tables, [*notes, *_disagreements(tables[PLANT_STATE])]


def _table(stamps: Integers, names: Sequence[str], values: Mapping[Signal, Floats]) -> Table:
    fields = {field: np.full((stamps.size, len(names)), np.nan) for field in FIELDS}
    for one, column in values.items():
        fields[ROLES[one.role].field][:, names.index(one.name)] = column
    return Table(stamps, stamps, stamps, tuple(names), **fields)


def _check_roles(columns: Columns, wanted: Wanted) -> None:
    if not any(one.role in MOTION for one in wanted.signals):
        raise InputError(
            f"{columns.source} has the columns {', '.join(columns.values)}, and none is said to be a "
            f"position, velocity or acceleration; say which is which, as --map position:{USUAL[True]}=COLUMN "
            f"--map force:{USUAL[False]}=COLUMN."
        )


def _names(wanted: Wanted, spec: Spec | None) -> dict[str, list[str]]:
    """Names by topic: of the plant's state all dofs, then what acts on them."""
    dofs = list(spec.plant.dofs) if spec and spec.plant else []
    dofs += [one.name for one in wanted.signals if ROLES[one.role].of_dof]
    found = {PLANT_STATE: dict.fromkeys(dofs)}
    for one in wanted.signals:
        found.setdefault(ROLES[one.role].topic, {})[one.name] = None
    return {topic: list(names) for topic, names in found.items()}


def _in_si(columns: Columns, one: Signal, wanted: Wanted) -> Floats:
    if one.column not in columns.values:
        raise no_column(columns, one.column)
    values = np.asarray(columns.values[one.column], dtype=float) - wanted.offset_of(one)
    si = ROLES[one.role].unit
    what = f"{one.role} {one.name} (column {one.column} of {columns.source})"
    values = values * factor(unit_in_file(columns, one, wanted), si, what)
    infinite = np.flatnonzero(np.isinf(values))
    if infinite.size:
        raise InputError(
            f"{columns.source}: {one.column} is {values[infinite[0]]} in sample {infinite[0] + 1}, but must "
            f"be finite; correct it, or leave the value out when it is not known."
        )
    if not np.isfinite(values).any():
        raise InputError(f"{columns.source}: {one.column} has no numbers; take another column.")
    return values


def unit_in_file(columns: Columns, one: Signal, wanted: Wanted) -> str:
    """Unit of a signal's column: that which the user gives, else that of the file, else SI."""
    return wanted.unit_of(one) or columns.units.get(one.column, ROLES[one.role].unit)


def _remarks(one: Signal, values: Floats) -> Iterator[str]:
    si = ROLES[one.role].unit
    unknown = int(np.count_nonzero(np.isnan(values)))
    if unknown:
        yield f"{unknown} of {values.size} values of {one.column} are missing: kept as not known."
    known = values[~np.isnan(values)]
    if known.size > 1 and not np.ptp(known):
        unit = "" if si == "1" else f" {si}"
        yield f"{one.column} is {known[0]:g}{unit} all the time: is it the right column?"
    largest = float(np.abs(known).max())
    if largest > LARGEST[si]:
        yield f"{one.role} {one.name} reaches {largest:.4g} {si}: is its unit right (--unit {one.role}=...)?"


def _disagreements(table: Table) -> Iterator[str]:
    """Whether velocities are the rates of their positions."""
    seconds = (table.stamp_ns - table.stamp_ns[:1]) * 1e-9
    for k, name in enumerate(table.names):
        x, v = table.position[:, k], table.velocity[:, k]
        if len(table) < 20 or not np.isfinite(x).all() or not np.isfinite(v).all() or not v.any():
            continue
        travelled = np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(seconds))
        moved = x[1:] - x[0]
        ratio = float(np.std(travelled) / max(np.std(moved), 1e-300))
        if not 1.0 / DISAGREE < ratio < DISAGREE:
            yield (
                f"the velocity of {name}, integrated, gives {ratio:.3g} times its change of position: "
                f"are both units right?"
            )
