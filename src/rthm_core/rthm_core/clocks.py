"""By how much the clocks of two hosts differ, from questions and answers between them.

    leader   asked                               heard
    node             received          answered

The offset of the node's clock is half of (received - asked) + (answered - heard); it is uncertain by half of
the time on the way, as nobody knows how that is shared by the two ways. Source: D. L. Mills, RFC 5905 (2010),
section 8.
"""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple

from rthm_core.clock import NS
from rthm_core.spec import Spec
from rthm_core.topics import COMMAND, NUMERICAL_STATE, PLANT_STATE

LIMIT = "clock"
"""Name of the limit on the offset."""

OFFSET_SHARE = 0.1
"""Offset that is allowed by default, as a share of the shortest delay of the loop."""

TICKS = {"td1": PLANT_STATE, "td2": NUMERICAL_STATE, "td3": COMMAND}
"""Topic that is stamped with the ticks of a clock."""

ENDS = {
    "tau1": ("plant", "actuator"),
    "tau2": ("plant", "numerical"),
    "tau3": ("numerical", "actuator"),
    "tau4": ("actuator", "plant"),
}
"""Nodes that stamp the sample and its use on each link."""


class Exchange(NamedTuple):
    """One question and its answer; all times in ns, `received` and `answered` by the node's clock."""

    asked: int
    received: int
    answered: int
    heard: int

    @property
    def offset(self) -> float:
        """Lead of the node's clock over the leader's, s."""
        return ((self.received - self.asked) + (self.answered - self.heard)) / 2 / NS

    @property
    def uncertainty(self) -> float:
        """By how much the offset may be wrong, either way, s."""
        return ((self.heard - self.asked) - (self.answered - self.received)) / 2 / NS


class Offset(NamedTuple):
    """Offset of a node's clock and its uncertainty, s, and when it was measured, ns by the leader's clock."""

    offset: float
    uncertainty: float
    at: int

    def as_dict(self) -> dict[str, float]:
        """What is told of it."""
        return {"offset": self.offset, "uncertainty": self.uncertainty}

    def beyond(self, limit: float) -> bool:
        """Whether the offset is certainly larger than `limit`, s."""
        return abs(self.offset) - self.uncertainty > limit


UNKNOWN = Offset(math.nan, math.inf, 0)


class Comparison:
    """Exchanges with one node, of which the quickest of the last ones is believed.

    Parameters
    ----------
    window
        How far back an exchange may lie, s: in a longer time a clock that drifts moves on.
    """

    def __init__(self, window: float = 0.5) -> None:
        self._window = round(window * NS)
        self._exchanges: deque[Exchange] = deque()

    def add(self, exchange: Exchange) -> None:
        """Take notice of an exchange."""
        self._exchanges.append(exchange)
        while self._exchanges[0].heard < exchange.heard - self._window:
            self._exchanges.popleft()

    def best(self) -> Offset:
        """Offset by the quickest exchange; `UNKNOWN` before the first."""
        if not self._exchanges:
            return UNKNOWN
        quickest = min(self._exchanges, key=lambda exchange: exchange.uncertainty)
        return Offset(quickest.offset, quickest.uncertainty, (quickest.asked + quickest.heard) // 2)


def limit_of(spec: Spec) -> float:
    """Largest offset between the clocks of two hosts, s; infinite where the loop has no delay."""
    if spec.limits is not None and spec.limits.clock is not None:
        return spec.limits.clock
    assert spec.timing is not None
    delays = [tau for name in ENDS if (tau := getattr(spec.timing, name)) > 0.0]
    return OFFSET_SHARE * min(delays, default=math.inf)
