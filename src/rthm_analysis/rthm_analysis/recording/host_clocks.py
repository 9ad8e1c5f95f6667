"""Clocks of the hosts of a test, as they were compared while it ran: topic ``clocks``.

A stamp is made by the clock of its node. Between nodes of two hosts an age is therefore wrong by the
difference of their clocks, and right again with the offsets that were measured.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from rthm_analysis.recording.table import Table
from rthm_core.clock import NS
from rthm_core.clocks import ENDS
from rthm_core.compiled import Floats, Integers

QUICK = 2.0
"""Uncertainty up to which an offset is used, as a multiple of the least: slow ways say little."""


@dataclass(frozen=True)
class HostClock:
    """Lead of the clock of one node over the leader's.

    Attributes
    ----------
    at_ns : (n,) array
        Instants at which it was told, n >= 1.
    offset, uncertainty : (n,) arrays
        Lead, and by how much it may be wrong either way, s.
    """

    at_ns: Integers
    offset: Floats
    uncertainty: Floats

    @property
    def drift(self) -> float:
        """Growth of the lead over the recording, s/s: slope of a straight line; 0 for a single value."""
        if self.at_ns.size < 2:
            return 0.0
        return float(np.polyfit((self.at_ns - self.at_ns[0]) / NS, self.offset, 1)[0])

    def as_dict(self) -> dict[str, float]:
        """What ``rthm timing`` tells of it, s and s/s."""
        return {
            "offset": float(np.median(self.offset)),
            "least": float(self.offset.min()),
            "most": float(self.offset.max()),
            "drift": self.drift,
            "uncertainty": float(np.median(self.uncertainty)),
        }


@dataclass(frozen=True)
class HostClocks:
    """Clocks that were compared, by the name of the node; others are the leader's own."""

    nodes: Mapping[str, HostClock] = field(default_factory=dict)

    def lead_ns(self, node: str, at_ns: Integers) -> Integers:
        """Lead of the clock of a node at instants, ns; held before the first and after the last message."""
        clock = self.nodes.get(node)
        if clock is None:
            return np.zeros(at_ns.shape, dtype=np.int64)
        return np.rint(np.interp(at_ns, clock.at_ns, clock.offset * NS)).astype(np.int64)

    def missing_age_ns(self, link: str, at_ns: Integers) -> Integers:
        """What ages on a link have to be longer than their stamps say, ns."""
        sender, receiver = ENDS[link]
        return self.lead_ns(sender, at_ns) - self.lead_ns(receiver, at_ns)


def host_clocks(table: Table | None) -> HostClocks:
    """Clocks by the messages of the topic ``clocks``: position is the lead, effort its uncertainty, s."""
    if table is None:
        return HostClocks()
    found = {}
    for column, name in enumerate(table.names):
        known = np.isfinite(table.position[:, column]) & np.isfinite(table.effort[:, column])
        if known.any():
            known &= table.effort[:, column] <= QUICK * table.effort[known, column].min()
            rows = (table.position[known, column], table.effort[known, column])
            found[name] = HostClock(table.stamp_ns[known], *rows)
    return HostClocks(found)
