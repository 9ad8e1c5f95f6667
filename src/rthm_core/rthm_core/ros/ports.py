"""Where samples leave and enter a node: publications, and links that keep a sample while it is delayed."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState, TimeReference

from rthm_core.link import Inbox, Link
from rthm_core.owner import UNNUMBERED, Ownership
from rthm_core.ros.messages import (
    FIELDS,
    JointSample,
    JointStateReader,
    JointStateWriter,
    TimeReferenceWriter,
)
from rthm_core.ros.polling import Info, Listener, Mailbox, PollingNode
from rthm_core.topics import link_topic

Values = Sequence[float] | NDArray[np.float64]


class Ports:
    """All ports of a node, and the time of the test as they see it.

    Parameters
    ----------
    polled
        Whether inputs receive only when they are asked to, instead of as soon as a sample arrives.

    Attributes
    ----------
    start
        Stamp of the start of the test, ns; None: the first sample that arrives sets it.
    now
        Gives the time since the start, ns.
    listening, speaking
        Whether samples are taken in, and whether they are published.
    """

    def __init__(self, node: PollingNode, qos: QoSProfile, polled: bool = False) -> None:
        self.node, self.qos, self.polled = node, qos, polled
        self.start: int | None = None
        self.now: Callable[[], int] = lambda: 0
        self.listening = self.speaking = False
        self.inputs: list[Input] = []
        self.outputs: list[Output] = []
        self._told: list[tuple[Publisher, bytes]] = []

    def output(
        self, topic: str, names: Sequence[str], fields: Sequence[str] = FIELDS, peers: int = 0
    ) -> Output:
        """Publish `topic`; at least `peers` nodes of the loop listen to it."""
        self.outputs.append(Output(self, topic, names, fields, peers))
        return self.outputs[-1]

    def input(self, topic: str, names: Sequence[str], link: Link, period: int = 0, spacing: int = 0) -> Input:
        """Subscribe to `topic` behind `link`."""
        self.inputs.append(Input(self, topic, names, link, period, spacing))
        return self.inputs[-1]

    def later(self, publisher: Publisher, data: bytes) -> None:
        """Publish what nobody waits for, once the samples of this instant are out."""
        if self.speaking:
            self._told.append((publisher, data))

    def flush(self) -> None:
        """Publish what was left for later."""
        for publisher, data in self._told:
            publisher.publish(data)
        self._told.clear()

    def clear(self) -> None:
        """Forget all samples and counts."""
        for port in self._all():
            port.clear()

    def close(self) -> None:
        """Leave all topics."""
        for port in self._all():
            port.close()
        self.inputs, self.outputs = [], []

    def waiting(self) -> list[str]:
        """Topics whose other side is not matched yet."""
        return [port.topic for port in self._all() if not port.matched()]

    def _all(self) -> list[Input | Output]:
        return [*self.inputs, *self.outputs]


class Output:
    """Publication of one topic of samples.

    Attributes
    ----------
    sent
        Messages of the present test.
    """

    def __init__(
        self, ports: Ports, topic: str, names: Sequence[str], fields: Sequence[str], peers: int
    ) -> None:
        self.topic, self.sent = topic, 0
        self._ports, self._peers = ports, peers
        self._bytes = JointStateWriter(names, fields).bytes
        self._publisher = ports.node.create_publisher(JointState, topic, ports.qos)

    def send(self, at: int, *fields: Values) -> None:
        """Publish a sample that belongs to the instant `at` (ns after the start)."""
        data = self._bytes((self._ports.start or 0) + at, *fields)
        if self._ports.speaking:
            self._publisher.publish(data)
            self.sent += 1

    def clear(self) -> None:
        """Begin a new test."""
        self.sent = 0

    def matched(self) -> bool:
        """Whether all listeners that the loop needs, and all that are known, are connected."""
        known = self._ports.node.count_subscribers(self._publisher.topic_name)
        return bool(self._publisher.get_subscription_count() >= max(self._peers, known))

    def close(self) -> None:
        """Leave the topic."""
        self._ports.node.destroy_publisher(self._publisher)


class Input:
    """Subscription of one topic of samples, behind a link.

    Parameters
    ----------
    names
        Names that the receiver needs, in the order in which it needs them.
    period
        Period of the topic, ns, if nothing is sent between its ticks: where samples have no numbers, gaps
        between their stamps then count as missing samples.
    spacing
        Mean distance of samples at their highest rate, ns, for telling a second publisher; 0: `period`.

    Attributes
    ----------
    inbox
        Samples that wait for the end of their delay.
    received, missing
        Messages of the present test, and how many never came.
    refused
        What was wrong with the last message that could not be used.
    ownership
        Tells samples of a second publisher, which are not used.
    seen
        Called with every sample as it arrives, also with those before the start.
    unread
        Called with what is wrong with a message that cannot be used.
    """

    def __init__(
        self, ports: Ports, topic: str, names: Sequence[str], link: Link, period: int = 0, spacing: int = 0
    ) -> None:
        self.topic, self.link = topic, link
        self._ports, self._period, self._width = ports, period, len(names)
        self._spacing = spacing or period
        self._read = JointStateReader(names).sample
        self.seen: Callable[[JointSample], None] | None = None
        self.unread: Callable[[str], None] = lambda why: None
        self._use = TimeReferenceWriter(link.name).bytes
        self.clear()
        self._uses = ports.node.create_publisher(TimeReference, link_topic(link.name), ports.qos)
        if ports.polled:
            self._listener: Listener = Mailbox(ports.node, JointState, topic, ports.qos)
        else:
            self._listener = Listener(ports.node, JointState, topic, ports.qos, self._receive)

    def clear(self) -> None:
        """Begin a new test."""
        self.inbox, self.refused = Inbox(), ""
        self.ownership = Ownership(self._spacing)
        self.received = self.missing = 0
        self._newest: int | None = None
        self._number = UNNUMBERED

    def rehearse(self) -> None:
        """Put a sample of zeros into the inbox that is due at the start."""
        zeros = [0.0] * self._width
        self.inbox.push(0, 0, JointSample(0, zeros, zeros, zeros))

    def take(self, at: int) -> JointSample | None:
        """Newest sample whose delay is over since the last call; its stamp is in ns after the start."""
        taken = self.inbox.take(at)
        return taken[1] if taken else None

    def tell(self, now: int, stamp: int) -> None:
        """Publish that the sample of this stamp is used at `now` (both ns after the start)."""
        start = self._ports.start or 0
        self._ports.later(self._uses, self._use(start + now, start + stamp))

    def poll(self) -> None:
        """Receive what has arrived, if samples are received when asked to."""
        if isinstance(self._listener, Mailbox):
            for data, info in self._listener.take():
                self._receive(data, info)

    def matched(self) -> bool:
        """Whether somebody publishes the topic, and all that are known are connected."""
        return self._listener.matched()

    def close(self) -> None:
        """Leave the topic."""
        self._listener.close()
        self._ports.node.destroy_publisher(self._uses)

    def _receive(self, data: bytes, info: Info) -> None:
        if not self._ports.listening:
            return
        number = info["publication_sequence_number"]
        before, self._number = self._number, number
        try:
            sample = self._read(data)
        except ValueError as error:
            self.refused = f"a message on {self.topic} {error}"
            self.unread(self.refused)
            return
        if self._ports.start is None:
            self._ports.start = sample.stamp
        if not self.ownership.accept(number, sample.stamp):
            return
        sample = sample._replace(stamp=sample.stamp - self._ports.start)
        if self.seen is not None:
            self.seen(sample)
        if sample.stamp >= 0:
            self.missing += self._missing(before, number, sample.stamp)
            self._keep(sample)

    def _missing(self, before: int, number: int, stamp: int) -> int:
        """How many samples of the test are missing between the last one and this one.

        Counted by the numbers that the publisher gave them; by the stamps only where there are none, as a
        wrong stamp is no loss, and neither is what was never sent.
        """
        if self._newest is None:
            return 0
        if max(before, number) < UNNUMBERED:
            return max(number - before - 1, 0)
        return max(round((stamp - self._newest) / self._period) - 1, 0) if self._period else 0

    def _keep(self, sample: JointSample) -> None:
        """Put a sample into the inbox; one that comes too late is due now."""
        self.received += 1
        self._newest = max(sample.stamp, self._newest or 0)
        due, now = self.link.due(sample.stamp), self._ports.now()
        self.inbox.push(sample.stamp, due if due is None else max(due, now), sample)
        self.inbox.late += due is not None and now > due
