"""What a node says of itself once a second on ``/diagnostics`` (REP-107)."""

from __future__ import annotations

from collections.abc import Mapping

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

from rthm_core.clock import NS
from rthm_core.ros.agenda import Ticks
from rthm_core.ros.ports import Input
from rthm_core.topics import DIAGNOSTICS

OK, WARN, ERROR = DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR


class Diagnostics:
    """Publishes the state of one node.

    Counts run from the start of the test; the level tells of what came new since the last report.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._publisher = node.create_publisher(DiagnosticArray, DIAGNOSTICS, 10)
        self._faults = 0

    def clear(self) -> None:
        """Begin a new test."""
        self._faults = 0

    def publish(self, stamp: int, *statuses: DiagnosticStatus) -> None:
        """Publish these statuses with a stamp in ns."""
        message = DiagnosticArray(status=list(statuses))
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, NS)
        self._publisher.publish(message)

    def loop(self, facts: Mapping[str, object], clocks: list[Ticks], inputs: list[Input]) -> DiagnosticStatus:
        """Status of the node's loop: its clocks and its links."""
        values = dict(facts)
        for clock in clocks:
            values |= _clock(clock)
        for port in inputs:
            values |= _link(port)
        faults = sum(clock.missed for clock in clocks) + sum(
            port.inbox.late + port.missing + bool(port.refused) for port in inputs
        )
        new, self._faults = faults > self._faults, faults
        words = next((port.refused for port in inputs if port.refused), "late" if new else "on time")
        return self.status("loop", WARN if new else OK, words, values)

    def status(self, part: str, level: bytes, message: str, values: Mapping[str, object]) -> DiagnosticStatus:
        """Status of one part of the node."""
        name = f"{self._node.get_fully_qualified_name()}: {part}"
        pairs = [KeyValue(key=key, value=str(value)) for key, value in values.items()]
        return DiagnosticStatus(
            level=level, name=name, message=message, hardware_id=self._node.get_name(), values=pairs
        )


def _clock(clock: Ticks) -> dict[str, object]:
    worst, clock.lateness = clock.lateness, 0
    return {
        f"{clock.name} period [s]": clock.period / NS,
        f"{clock.name} ticks": clock.done,
        f"{clock.name} missed deadlines": clock.missed,
        f"{clock.name} worst lateness [s]": worst / NS,
    }


def _link(port: Input) -> dict[str, object]:
    inbox, name = port.inbox, port.link.name
    return {
        f"{name} received": port.received,
        f"{name} late": inbox.late,
        f"{name} lost": inbox.lost + port.missing,
        f"{name} dropped": inbox.dropped,
    }
