"""Decoded topics as tables: columns with units, times in integer nanoseconds, in time order.

A signal of the loop is held between its samples: it is a step, never a straight line. `hold` is the only way
to read a table between its rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from rthm_analysis.recording.cdr import FIELDS, decode_joint_states, decode_time_references
from rthm_analysis.recording.raw import RawTopic

if TYPE_CHECKING:
    from rthm_core.compiled import Flags, Floats, Integers


@dataclass(frozen=True)
class Table:
    """Samples of one JointState topic, one row each, in the order of their stamps; NaN: not known.

    Attributes
    ----------
    stamp_ns : (n,) array
        Instant to which the values belong.
    received_ns, sent_ns : (n,) arrays
        Instants at which the recorder received the sample, and at which its source sent it; the former again
        where the recording does not tell the latter.
    names : tuple of k str
        Column names: degrees of freedom, actuators or energy terms.
    position, velocity, effort : (n, k) arrays
        m, m/s and N (J for the topic ``energy``, m/s^2 for ``plant/acceleration``, units of their own for
        inputs).
    """

    stamp_ns: Integers
    received_ns: Integers
    sent_ns: Integers
    names: tuple[str, ...]
    position: Floats
    velocity: Floats
    effort: Floats

    def __len__(self) -> int:
        return self.stamp_ns.size

    def columns(self, field: str, names: Sequence[str]) -> Floats:
        """Return columns of ``position``, ``velocity`` or ``effort`` (n, len(names)); NaN: not there."""
        values = getattr(self, field)
        picked = np.full((len(self), len(names)), np.nan)
        for column, name in enumerate(names):
            if name in self.names:
                picked[:, column] = values[:, self.names.index(name)]
        return picked

    def only(self, names: Sequence[str]) -> Table:
        """Return the columns of some names."""
        position, velocity, effort = (self.columns(field, names) for field in FIELDS)
        return replace(self, names=tuple(names), position=position, velocity=velocity, effort=effort)

    def rows(self, which: Integers | slice) -> Table:
        """Return some of the samples."""
        picked = {
            name: getattr(self, name)[which] for name in ("stamp_ns", "received_ns", "sent_ns", *FIELDS)
        }
        return replace(self, **picked)


@dataclass(frozen=True)
class LinkTable:
    """Uses of one link in time order: which sample its receiver used at which instant.

    Attributes
    ----------
    use_ns, sample_ns, received_ns, sent_ns : (n,) arrays
        Instant of use, stamp of the sample used, and when this was received by the recorder and sent, as in
        `Table`.
    """

    use_ns: Integers
    sample_ns: Integers
    received_ns: Integers
    sent_ns: Integers

    def __len__(self) -> int:
        return self.use_ns.size

    def rows(self, which: Integers | slice) -> LinkTable:
        """Return some of the uses."""
        return LinkTable(*(times[which] for times in vars(self).values()))


T = TypeVar("T", Table, LinkTable)


Held = TypeVar("Held", "Floats", "Integers")


def hold(table_times: Integers, values: Held, at: Integers) -> Held:
    """Value of a held signal at the instants `at`.

    Parameters
    ----------
    table_times : (n,) array
        Ascending instants, n >= 1; a value belongs to its own instant and to all after it up to the next one.
    values : (n, ...) array
    at : (m,) array
        Before the first instant the first value holds.

    Returns
    -------
    (m, ...) array
    """
    return values[np.maximum(np.searchsorted(table_times, at, side="right") - 1, 0)]


def rows_of(times: Integers, wanted: Integers) -> tuple[Integers, Flags]:
    """Where some instants stand among others.

    Parameters
    ----------
    times : (n,) array
        Ascending instants, n >= 1.
    wanted : (m,) array

    Returns
    -------
    row : (m,) array
        Of the instant itself, else of the next one, or of the last one.
    found : (m,) array
        Whether the instant is among them.

    Examples
    --------
    >>> rows_of(np.array([10, 20, 30]), np.array([20, 25, 40]))
    (array([1, 2, 2]), array([ True, False, False]))
    """
    row = np.minimum(np.searchsorted(times, wanted), times.size - 1)
    return row, times[row] == wanted


def joint_table(topic: RawTopic) -> tuple[Table, list[str]]:
    """Table of a JointState topic, and what had to be mended, as sentences."""
    blocks = list(decode_joint_states(topic))
    names = tuple(dict.fromkeys(name for block in blocks for name in block.names))
    count = len(topic)
    stamps, filled = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=bool)
    fields = {field: np.full((count, len(names)), np.nan) for field in FIELDS}
    unlike = 0
    for block in blocks:
        stamps[block.indices], filled[block.indices] = block.stamp_ns, True
        where = [names.index(name) for name in block.names]
        for field, values in block.values.items():
            if values.shape[1] == len(where):
                fields[field][np.ix_(block.indices, np.asarray(where, dtype=np.int64))] = values
            elif values.shape[1]:
                unlike += len(block.indices)
    table = Table(stamps, topic.received_ns, topic.sent_ns, names, **fields).rows(np.flatnonzero(filled))
    table, notes = _in_time_order(table, topic, table.stamp_ns)
    if unlike:
        notes.append(f"{topic.name}: {unlike} arrays do not have one number for each name: left out.")
    return table, notes


def link_table(topic: RawTopic) -> tuple[LinkTable, list[str]]:
    """Table of a TimeReference topic, and what had to be mended, as sentences."""
    count = len(topic)
    uses, samples = np.zeros((2, count), dtype=np.int64)
    filled = np.zeros(count, dtype=bool)
    for block in decode_time_references(topic):
        uses[block.indices], samples[block.indices] = block.use_ns, block.sample_ns
        filled[block.indices] = True
    table = LinkTable(uses, samples, topic.received_ns, topic.sent_ns).rows(np.flatnonzero(filled))
    return _in_time_order(table, topic, table.use_ns, table.sample_ns)


def _in_time_order(table: T, topic: RawTopic, *keys: Integers) -> tuple[T, list[str]]:
    """Sort by `keys`, the time first; of several rows with the same keys the last received one stays."""
    notes = []
    if len(table) < len(topic):
        undecoded = len(topic) - len(table)
        notes.append(f"{topic.name}: {undecoded} messages could not be decoded as {topic.type}: left out.")
    late = int(np.count_nonzero(np.diff(keys[0]) < 0))
    if late:
        notes.append(
            f"{topic.name}: {late} messages came after a later one: put into the order of their stamps."
        )
    order = np.lexsort(keys[::-1])
    differs = np.logical_or.reduce([np.diff(key[order]) != 0 for key in keys])
    last = np.append(differs, True)[: order.size]
    if not last.all():
        twins = int(np.count_nonzero(~last))
        notes.append(
            f"{topic.name}: {twins} messages have the stamp of a later one: the last received was kept."
        )
    return table.rows(order[last]), notes
