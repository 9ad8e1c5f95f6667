"""What came since the last look, decoded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rthm_analysis.live import FAR_NS
from rthm_analysis.recording.raw import RawTopic
from rthm_analysis.recording.table import LinkTable, Table, joint_table, link_table
from rthm_core.clock import NS
from rthm_core.compiled import Floats, Integers
from rthm_core.topics import CLOCKS, DRY_COMMAND, ENERGY, JOINT_STATE, LOOP, TIME_REFERENCE, link_topic

TOPICS = LOOP | dict.fromkeys((DRY_COMMAND, ENERGY, CLOCKS), JOINT_STATE)
"""Topics that are shown, by relative name, and their types."""

END = NS // 10
"""How much of the samples before is kept: whoever holds signals may be so far behind, ns."""

MESSAGES_WAITING = 20_000
"""Messages of a topic that wait at most; of more, the first ones are not shown."""


@dataclass(frozen=True)
class Fresh:
    """Samples since the last look, of each topic with those of the `END` before them.

    Attributes
    ----------
    tables, links : dict
        By topic, and by link; a topic from which nothing ever came is not there.
    """

    tables: dict[str, Table]
    links: dict[str, LinkTable]

    def columns(self, topic: str, field: str, names: tuple[str, ...]) -> Floats:
        """Columns (n, names) of a topic; n = 0 where nothing ever came."""
        table = self.tables.get(topic)
        return np.empty((0, len(names))) if table is None else table.columns(field, names)

    def stamps(self, topic: str) -> Integers:
        """Stamps of a topic, ns."""
        table = self.tables.get(topic)
        return np.empty(0, dtype=np.int64) if table is None else table.stamp_ns


class Waiting:
    """Messages that wait, as bytes, until somebody looks: by the code that reads a recording."""

    def __init__(self) -> None:
        self._raw: dict[str, RawTopic] = {}
        self._tails: dict[str, Table] = {}
        self._newest = 0

    def take(self, topic: str, message: bytes) -> None:
        """Keep a message of one of `TOPICS`."""
        raw = self._raw.get(topic)
        if raw is None or len(raw) >= MESSAGES_WAITING:
            raw = self._raw[topic] = RawTopic(topic, TOPICS[topic])
        raw.append(0, message)

    def look(self, begin_ns: int) -> Fresh:
        """Return what has come and belongs to the test that began at `begin_ns`."""
        raw, self._raw = self._raw, {}
        links, tables = {}, dict(self._tails)
        for topic, waiting in raw.items():
            if TOPICS[topic] == TIME_REFERENCE:
                uses = link_table(waiting)[0]
                links[topic.removeprefix(link_topic(""))] = uses.rows(np.flatnonzero(uses.use_ns >= begin_ns))
                continue
            table = self._within(joint_table(waiting)[0], begin_ns)
            if len(table):
                tables[topic] = self._with_tail(topic, table)
                self._tails[topic] = _end_of(tables[topic])
        return Fresh(tables, links)

    def _within(self, table: Table, begin_ns: int) -> Table:
        """Samples of the test; one that is far ahead of all others has a wrong stamp."""
        stamps = table.stamp_ns[table.stamp_ns >= begin_ns]
        until = (self._newest or int(stamps.min(initial=np.iinfo(np.int64).max - FAR_NS))) + FAR_NS
        table = table.rows(np.flatnonzero((table.stamp_ns >= begin_ns) & (table.stamp_ns <= until)))
        self._newest = int(table.stamp_ns.max(initial=self._newest))
        return table

    def _with_tail(self, topic: str, table: Table) -> Table:
        tail = self._tails.get(topic)
        if tail is None or tail.names != table.names:
            return table
        joined = {
            name: np.concatenate([getattr(tail, name), getattr(table, name)])
            for name in ("stamp_ns", "received_ns", "sent_ns", "position", "velocity", "effort")
        }
        whole = Table(names=table.names, **joined)
        return whole.rows(np.argsort(whole.stamp_ns, kind="stable"))


def _end_of(table: Table) -> Table:
    """Samples that hold in the last `END`: those in it and the one before."""
    first = int(np.searchsorted(table.stamp_ns, table.stamp_ns[-1] - END, side="right")) - 1
    return table.rows(slice(max(first, 0), None))
