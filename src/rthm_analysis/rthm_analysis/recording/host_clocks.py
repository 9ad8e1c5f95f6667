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

QUICK_WAY = 2.0
"""Uncertainty up to which an offset is used, as a multiple of the least: slow ways say little."""

GRAIN = 1e-7
"""Least uncertainty that is believed, s."""


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
        return self._line(1)[0]

    def lead_ns(self, at_ns: Integers) -> Integers:
        """Lead at instants by the clock of the node itself, ns.

        The plainest clock that all measured values allow: always as far ahead, or running evenly. Where they
        allow neither, the lead goes from one value to the next, and is held before the first and after the
        last.
        """
        for slope, first in (self._line(0), self._line(1)):
            if np.all(np.abs(self.offset - first - slope * self._seconds) <= self.uncertainty):
                since = (at_ns - self.at_ns[0]) / NS  # which is later by the lead than on the leader's clock
                return np.asarray(np.rint((first + slope * since) / (1.0 + slope) * NS).astype(np.int64))
        lead = self.offset * NS
        return np.rint(np.interp(at_ns, self.at_ns + lead, lead)).astype(np.int64)

    @property
    def _seconds(self) -> Floats:
        return np.asarray((self.at_ns - self.at_ns[0]) / NS)

    def _line(self, degree: int) -> tuple[float, float]:
        """Slope and first value of a constant (0) or straight (1) lead, weighted by the uncertainties."""
        degree = min(degree, self.at_ns.size - 1)
        weight = 1.0 / np.maximum(self.uncertainty, GRAIN)
        *slope, first = np.polyfit(self._seconds, self.offset, degree, w=weight)
        return float(slope[0]) if slope else 0.0, float(first)

    def words(self, node: str) -> str:
        """Sentence on the clock of a node."""
        least, most = self.offset.min() * 1e3, self.offset.max() * 1e3
        return (
            f"The clock of {node} was {least:.3f} to {most:.3f} ms ahead of the leader's; ages are corrected."
        )

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
    """Clocks that were compared.

    Attributes
    ----------
    nodes : mapping of HostClock
        By the name of the node; all others have the leader's clock.
    applied : bool
        Whether the stamps of the recording are all by the leader's clock already: nothing is hidden then.
    """

    nodes: Mapping[str, HostClock] = field(default_factory=dict)
    applied: bool = False

    def lead_ns(self, node: str, at_ns: Integers) -> Integers:
        """What has to be taken off stamps of a node to have them by the leader's clock, ns."""
        clock = self.nodes.get(node)
        if clock is None or self.applied:
            return np.zeros(at_ns.shape, dtype=np.int64)
        return clock.lead_ns(at_ns)

    def uncertainty(self, link: str) -> float:
        """By how much the clocks at the two ends of a link may differ from what was measured, s."""
        known = (self.nodes[node] for node in ENDS[link] if node in self.nodes)
        return sum(float(np.median(clock.uncertainty)) for clock in known)

    def missing_age_ns(self, link: str, use_ns: Integers, sample_ns: Integers) -> Integers:
        """What ages on a link have to be longer than their stamps say, ns."""
        sender, receiver = ENDS[link]
        return self.lead_ns(sender, sample_ns) - self.lead_ns(receiver, use_ns)


def host_clocks(table: Table | None) -> HostClocks:
    """Clocks by the messages of the topic ``clocks``: position is the lead, effort its uncertainty, s."""
    if table is None:
        return HostClocks()
    found = {}
    for column, name in enumerate(table.names):
        known = np.isfinite(table.position[:, column]) & np.isfinite(table.effort[:, column])
        if known.any():
            known &= table.effort[:, column] <= QUICK_WAY * table.effort[known, column].min()
            rows = (table.position[known, column], table.effort[known, column])
            found[name] = HostClock(table.stamp_ns[known], *rows)
    return HostClocks(found)
