"""Topics as columns and back: ``plant/state`` is a file ``plant_state`` with ``x1.position [m]``, ..."""

from __future__ import annotations

import numpy as np

from rthm_analysis.exchange.columns import Column, Columns
from rthm_analysis.recording import LinkTable, Recording, Table
from rthm_analysis.recording.cdr import FIELDS
from rthm_analysis.recording.reading import STATES
from rthm_core.errors import InputError
from rthm_core.topics import ACCELERATION, ENERGY, INPUTS, LINKS

UNITS = {"position": "m", "velocity": "m/s", "effort": "N"}
OTHER_UNITS = {ENERGY: "J", INPUTS: "1", ACCELERATION: "m/s^2"}
"""Units of the fields, and of all fields of topics that have another."""

STAMP, RECEIVED, SENT, SAMPLE = "stamp", "received", "sent", "sample"

INSTANTS = (STAMP, RECEIVED, SENT)
"""Columns of times that every topic has."""

FILES = {name.replace("/", "_"): name for name in STATES} | {f"links_{name}": name for name in LINKS}
"""Topics and links by the name of their file."""


def columns_by_file(recording: Recording) -> dict[str, Columns]:
    """Everything in a recording, by the name of the file that it belongs into."""
    source = str(recording.path)
    found = {
        name.replace("/", "_"): Columns(source, *state_columns(table, name))
        for name, table in recording.tables.items()
    }
    times = {STAMP: "ns", SAMPLE: "ns", RECEIVED: "ns", SENT: "ns"}
    for name, link in recording.links.items():
        values: dict[str, Column] = {
            STAMP: link.use_ns,
            SAMPLE: link.sample_ns,
            RECEIVED: link.received_ns,
            SENT: link.sent_ns,
        }
        found[f"links_{name}"] = Columns(source, values, times)
    return found


def state_columns(table: Table, topic: str) -> tuple[dict[str, Column], dict[str, str]]:
    """Columns of a table and their units; of a name of which nothing is known, one column stays."""
    values: dict[str, Column] = dict(
        zip(INSTANTS, (table.stamp_ns, table.received_ns, table.sent_ns), strict=True)
    )
    units = dict.fromkeys(INSTANTS, "ns")
    for k, name in enumerate(table.names):
        known = [field for field in FIELDS if np.isfinite(getattr(table, field)[:, k]).any()] or ["effort"]
        for field in known:
            values[f"{name}.{field}"] = getattr(table, field)[:, k]
            units[f"{name}.{field}"] = OTHER_UNITS.get(topic, UNITS[field])
    return values, units


def state_table(columns: Columns) -> Table:
    """Table of a topic; InputError when a column has another name than ``x1.position``."""
    stamps = _instants(columns, STAMP)
    names: dict[str, None] = {}
    fields: dict[str, dict[str, Column]] = {field: {} for field in FIELDS}
    for heading, values in columns.values.items():
        if heading in INSTANTS:
            continue
        name, _, field = heading.rpartition(".")
        if not name or field not in FIELDS:
            raise InputError(
                f"{columns.source} has a column {heading!r}, but it must be {STAMP}, {RECEIVED}, {SENT}, or "
                f"NAME.position, NAME.velocity or NAME.effort; rename or remove it."
            )
        names[name] = None
        fields[field][name] = values
    filled = {
        field: np.stack([given.get(name, np.full(stamps.size, np.nan)) for name in names], axis=1)
        for field, given in fields.items()
    }
    return Table(stamps, *_travel(columns, stamps), tuple(names), **filled)


def link_table(columns: Columns) -> LinkTable:
    """Table of a link; InputError when a column is missing."""
    stamps = _instants(columns, STAMP)
    return LinkTable(stamps, _instants(columns, SAMPLE), *_travel(columns, stamps))


def _travel(columns: Columns, stamps: Column) -> tuple[Column, Column]:
    """When samples were received and sent, as far as the columns tell."""
    received = _instants(columns, RECEIVED, stamps)
    return received, _instants(columns, SENT, received)


def _instants(columns: Columns, name: str, default: Column | None = None) -> Column:
    values = columns.values.get(name, default)
    if values is None:
        raise InputError(f"{columns.source} has no column {name}, in ns; add it.")
    if values.dtype != np.int64:
        raise InputError(
            f"{columns.source}: {name} must be whole nanoseconds, with the heading '{name} [ns]'; correct it."
        )
    return values
