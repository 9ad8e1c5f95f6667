"""The recorder: a node that writes every topic of the test to a bag, until the motors have stopped.

Messages stay the bytes they are. The bag is opened, with the spec in it, when the node is configured; samples
of the loop are taken while it is active; it is closed when the node is deactivated.
"""

from __future__ import annotations

import gc
import os
import signal
import sys
import time
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions
from sensor_msgs.msg import JointState, TimeReference
from std_msgs.msg import String
from std_srvs.srv import Trigger

from rthm_analysis.recording.writing import BagWriter
from rthm_bringup.run.intake import Intake
from rthm_core.clock import to_ns
from rthm_core.clocks import TICKS
from rthm_core.errors import InputError
from rthm_core.ros import leader, reach, system
from rthm_core.ros.alive import Alive
from rthm_core.ros.granted import Observer
from rthm_core.ros.managed import refuse_impossible_transitions, refuse_past
from rthm_core.ros.polling import Mailbox, PollingNode
from rthm_core.ros.process import built, serving
from rthm_core.spec import Spec, read_spec, write_spec
from rthm_core.topics import (
    BESIDE,
    COMMAND,
    DIAGNOSTIC_ARRAY,
    DIAGNOSTICS,
    JOINT_STATE,
    LOOP,
    NAMESPACE,
    SPEC,
    STRING,
    TIME_REFERENCE,
)

TOPICS = LOOP | BESIDE
TYPES = {
    STRING: String,
    JOINT_STATE: JointState,
    TIME_REFERENCE: TimeReference,
    DIAGNOSTIC_ARRAY: DiagnosticArray,
}
DEPTH = 1000
PRIORITY = 20  # below the loop, above all that only computes
FLUSH = 0.2  # s
MOTORS_STOP_WITHIN = 15.0
"""How long the recorder goes on for motors that do not stop, s."""
STOPPED_AFTER = 0.3
"""How long no command may come before the motors count as having stopped, s."""
TAKE = 0.01
"""Time between two looks at what has arrived, s."""

PARAMETERS: dict[str, tuple[Any, str]] = {
    "bag": ("", "folder of the recording; it must not exist, or be empty"),
    "spec_file": ("", "spec of the test, which goes into the bag first"),
    "start_time": (0, "begin of the test [ns]; 0: whatever comes after activation belongs to it"),
    "duration": (0.0, "length of the test [s]; 0: until the node is deactivated"),
    "priority": (PRIORITY, "real-time priority (SCHED_FIFO) that is asked for; 0: none"),
    "virtual": (False, "whether stamps are simulated time"),
    "autostart": (False, "configure and activate at once"),
    "silent": ([""], "topics of the loop that have no samples in this test"),
    "awaited": (list(LOOP), "topics that must have a publisher before the test begins"),
}


class Recorder(PollingNode):
    """Lifecycle node around `Intake`."""

    def __init__(self) -> None:
        super().__init__("recorder", namespace=NAMESPACE)
        leader.answer_only_to_leader(self)
        refuse_impossible_transitions(self)
        for name, (value, description) in PARAMETERS.items():
            self.declare_parameter(name, value, ParameterDescriptor(description=description))
        self._diagnostics = self.create_publisher(DiagnosticArray, DIAGNOSTICS, 10)
        self._alive = Alive(self)
        self._intake: Intake | None = None
        self._observer: Observer | None = None
        self._mailboxes: dict[str, Mailbox] = {}
        self.failure: str | None = None
        self._commanded = float("-inf")
        self.create_service(Trigger, "~/ready", self._ready)
        self.create_service(Trigger, "~/complete", self._complete)

    def start(self) -> None:
        """Configure and activate without being led, if the parameter says so."""
        if not self._value("autostart"):
            return
        if self.trigger_configure() == TransitionCallbackReturn.SUCCESS:
            self.trigger_activate()
        else:
            self.failure = self.failure or "the recorder could not be configured."

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Open the bag, write and publish the spec, and subscribe."""
        try:
            self._open()
        except InputError as error:
            return self._refuse(str(error))
        for topic, type_name in TOPICS.items():
            self._mailboxes[topic] = Mailbox(self, TYPES[type_name], topic, QoSProfile(depth=DEPTH))
        if self._value("virtual") and self._observer is None:
            self._observer = Observer(self)
        self._flush_timer = self.create_timer(FLUSH, self._flush)
        self._report_timer = self.create_timer(1.0, self._report)
        if self._value("virtual"):
            system.prepare_virtual()
        else:
            system.prepare(self._value("priority"), lock_memory=False)
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Take samples from the start of the test on."""
        assert self._intake is not None
        begin, duration = self._value("start_time"), to_ns(self._value("duration"))
        try:
            refuse_past(0 if self._value("virtual") else begin)
        except InputError as error:
            return self._refuse(str(error))
        known = duration and (begin or self._value("virtual"))
        self._intake.open(begin, begin + duration if known else None)
        if self._observer is not None:
            self._observer.greet()
        return super().on_activate(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Close the bag."""
        self._close()
        return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Be ready for another test."""
        self._close()
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Leave a closed bag behind."""
        self._close()
        return TransitionCallbackReturn.SUCCESS

    def destroy_node(self) -> None:
        """Leave a closed bag behind, also when the process is asked to end."""
        self._close()
        super().destroy_node()

    def _open(self) -> None:
        spec = read_spec(self._value("spec_file"))
        text, self._periods = write_spec(spec), periods_of(spec)
        writer = BagWriter(self._value("bag"))
        names = {name: self.resolve_topic_name(name) for name in (SPEC, *LOOP, *BESIDE)}
        self._intake = Intake(writer, names, self._value("virtual"))
        self._intake.put_spec(text, 0 if self._value("virtual") else time.time_ns())
        writer.flush()
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._spec = self.create_publisher(String, SPEC, latched)
        self._spec.publish(String(data=text))

    def turn(self) -> None:
        """Write what has arrived, and say that the recorder is alive."""
        self.take()
        if not self._value("virtual"):
            self._alive.beat()

    def still(self, asked: float) -> bool:
        """Whether the motors have stopped, or do not stop long after the end was `asked` for, s."""
        now = time.monotonic()
        return (
            self._intake is None or now > self._commanded + STOPPED_AFTER or now > asked + MOTORS_STOP_WITHIN
        )

    def take(self) -> None:
        """Write what has arrived, in the order in which it arrived."""
        taken = [(info, topic, data) for topic, box in self._mailboxes.items() for data, info in box.take()]
        if self._intake is None:
            return
        try:
            if any(topic == COMMAND for _, topic, _ in taken):
                self._commanded = time.monotonic()
            for info, topic, data in sorted(taken, key=lambda one: one[0]["received_timestamp"]):
                self._intake.take(topic, TOPICS[topic], data, info)
                if self._observer is not None:
                    self._observer.note(topic)
        except InputError as error:
            self._fail(str(error))

    def _flush(self) -> None:
        if self._intake is None:
            return
        try:
            self._intake.writer.flush()
        except InputError as error:
            self._fail(str(error))

    def _close(self) -> None:
        if self._intake is None:
            return
        self.take()
        intake, self._intake = self._intake, None
        intake.writer.custom |= {"lost": str(intake.lost), "twice": str(intake.twice)}
        try:
            intake.writer.close()
        except InputError as error:
            self._fail(str(error))
        for mailbox in self._mailboxes.values():
            mailbox.close()
        self._mailboxes.clear()

    def _ready(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        missing = [
            topic
            for topic in self._value("awaited")
            if topic not in self._mailboxes or not self._mailboxes[topic].publishers()
        ]
        response.success = not missing
        response.message = f"waits for {', '.join(missing)}" if missing else "ready"
        return response

    def _complete(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Service ``~/complete``: whether everything up to the end of the test has arrived."""
        self.take()
        due = {topic: period for topic, period in self._periods.items() if topic not in self._value("silent")}
        behind = self._intake.behind(due) if self._intake else ["there is no recording"]
        response.success, response.message = not behind, ", ".join(behind)
        return response

    def _report(self) -> None:
        if self._intake is None:
            return
        counts = self._intake.writer.counts
        values: dict[str, object] = {"messages": sum(counts.values()), "lost": self._intake.lost, **counts}
        values |= {"reach": os.environ.get(reach.VARIABLE, reach.OPEN)}
        level = DiagnosticStatus.WARN if self._intake.lost else DiagnosticStatus.OK
        status = DiagnosticStatus(level=level, name=self.get_fully_qualified_name(), message="recording")
        status.values = [KeyValue(key=key, value=str(value)) for key, value in values.items()]
        message = DiagnosticArray(status=[status])
        message.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(message)

    def _value(self, name: str) -> Any:
        return self.get_parameter(name).value

    def _refuse(self, sentence: str) -> TransitionCallbackReturn:
        print(sentence, file=sys.stderr, flush=True)
        return TransitionCallbackReturn.FAILURE

    def _fail(self, sentence: str) -> None:
        """End the process: a test that is not recorded must not go on unnoticed."""
        self._intake = None
        self.failure = sentence


def periods_of(spec: Spec) -> dict[str, int]:
    """Periods of the topics that are published at the ticks of a clock, ns."""
    timing = spec.loop().timing
    return {topic: timing.ns(clock) for clock, topic in TICKS.items()}


def main() -> int:
    """Run the node until it is asked to end and the motors have stopped; 1 when the recording failed."""
    asked: list[float] = []
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    # An exception from Python's handler would abort the executor.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda number, frame: asked.append(time.monotonic()))
    node = built(Recorder)
    with serving(node) as executor:
        node.start()
        gc.freeze()
        while rclpy.ok() and node.failure is None and not (asked and node.still(asked[0])):
            executor.spin_once(timeout_sec=TAKE)
            node.turn()
    if node.failure is not None:
        print(node.failure, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
