"""Quality of service of every topic.

Samples are reliable and the last `depth` are kept. Depth 1 loses samples even on one machine, and a machine
that stalls needs as many places as samples come meanwhile. Over a lossy network,
reliable delivery holds back everything behind a lost sample; choose best effort there, and see them counted.
"""

from __future__ import annotations

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

DEPTH = 1000
"""Samples kept for a slow receiver: about a second of the fastest topic."""


def samples(depth: int = DEPTH, reliable: bool = True) -> QoSProfile:
    """Topics of the loop."""
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.VOLATILE,
    )


def latched() -> QoSProfile:
    """Topics with one message that late joiners get as well: the spec."""
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=1,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
    )
