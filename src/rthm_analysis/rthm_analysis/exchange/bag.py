"""Tables as a bag: the same topics and messages as those of a recorded test."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from rthm_analysis.recording import LinkTable, Table
from rthm_analysis.recording.cdr import FIELDS
from rthm_analysis.recording.writing import BagWriter
from rthm_core.ros.cdr import ENCAPSULATION, string
from rthm_core.ros.messages import JointStateWriter, TimeReferenceWriter
from rthm_core.topics import JOINT_STATE, NAMESPACE, STRING, TIME_REFERENCE, link_topic

Row = tuple[int, int, int, str, str, bytes]
"""Received, stamp, sent (ns), topic, type, message."""


def write_bag(
    folder: Path, tables: Mapping[str, Table], links: Mapping[str, LinkTable], spec_text: str
) -> None:
    """Write a bag with the spec first and then all samples in the order of their reception.

    Raises
    ------
    InputError
        The folder is not empty, or cannot be written.
    """
    rows = [row for name, table in tables.items() for row in _states(name, table)]
    rows += [row for name, link in links.items() for row in _uses(name, link)]
    rows.sort(key=lambda row: row[:2])
    with BagWriter(folder) as bag:
        bag.add_topic(f"{NAMESPACE}/spec", STRING, depth=1, latched=True)
        if spec_text:
            first = rows[0][0] if rows else 0
            bag.write(f"{NAMESPACE}/spec", STRING, ENCAPSULATION + string(spec_text), first, first)
        for received, _, sent, topic, kind, message in rows:
            bag.write(topic, kind, message, received, sent)


def _states(name: str, table: Table) -> Iterator[Row]:
    """Messages of one JointState topic; a field that nothing is known of is an empty array."""
    fields = [field for field in FIELDS if np.isfinite(getattr(table, field)).any()] or ["effort"]
    writer = JointStateWriter(table.names, fields)
    columns = (getattr(table, field) for field in fields)
    times = (times.tolist() for times in (table.stamp_ns, table.received_ns, table.sent_ns))
    for stamp, received, sent, *values in zip(*times, *columns, strict=True):
        yield received, stamp, sent, f"{NAMESPACE}/{name}", JOINT_STATE, writer.bytes(stamp, *values)


def _uses(name: str, link: LinkTable) -> Iterator[Row]:
    writer = TimeReferenceWriter(name)
    for use, sample, received, sent in zip(*(times.tolist() for times in vars(link).values()), strict=True):
        yield (
            received,
            use,
            sent,
            f"{NAMESPACE}/{link_topic(name)}",
            TIME_REFERENCE,
            writer.bytes(use, sample),
        )
