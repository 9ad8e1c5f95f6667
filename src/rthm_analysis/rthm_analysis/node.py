"""Node ``analysis``: the energy ledger of a running test, and the analysis of a recording.

While it is active it listens to the loop, keeps the books, and publishes them on ``energy`` ten times a
second. A recording is analysed when the parameter ``bag`` names one at configuration, when the service
``~/run`` is called, and when the recorder closes the one that it was writing: the energies go beside the bag
as JSON, the verdict to ``/diagnostics``. Command line, page and node are the same code.
"""

from __future__ import annotations

import sys
import time
from functools import partial
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from lifecycle_msgs.msg import State, TransitionEvent
from rcl_interfaces.msg import ParameterDescriptor
from rcl_interfaces.srv import GetParameters
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState, TimeReference
from std_srvs.srv import Trigger

from rthm_analysis.bag_analysis import analyse_bag, write_beside
from rthm_analysis.energy import rehearse
from rthm_analysis.live import JOINT_STATE, TOPICS, LiveLedger
from rthm_analysis.report.verdict import BAD, verdict
from rthm_core.errors import InputError
from rthm_core.ros import parameters
from rthm_core.ros.messages import JointStateWriter
from rthm_core.ros.parameters import declare_spec, spec_of
from rthm_core.ros.process import run
from rthm_core.ros.qos import samples
from rthm_core.spec import Spec

PERIOD = 0.1
"""Between two messages on ``energy``, s."""

DEPTH = 1000
"""Samples of a topic that wait while the node is busy: about a second of the fastest one."""

TERMS = (
    "E_num", "E_ff", "E_fx", "E_err", "E_damping", "E_load", "E_effects", "E_total", "balance_error",
)  # fmt: skip
"""Names on ``energy``."""

OWN: dict[str, tuple[Any, str]] = {
    "bag": ("", "recording to analyse; empty: the one that the recorder has closed"),
    "start_time": (0, "instant of the start of the test [ns]; 0: the first sample of the plant"),
    "duration": (0.0, "length of the test [s]; the node ends when it is deactivated"),
    "virtual": (False, "whether stamps are simulated time"),
    "autostart": (False, "configure and activate at once"),
}
"""Parameters of the node, beside the spec."""


class AnalysisNode(LifecycleNode):
    """Listens, counts, tells."""

    def __init__(self) -> None:
        super().__init__("analysis", namespace="/rthm", allow_undeclared_parameters=True)
        self._besides = {*self._parameters, *OWN, *parameters.OWN}
        for name, (value, description) in OWN.items():
            self.declare_parameter(name, value, ParameterDescriptor(description=description))
        declare_spec(self, self._besides)
        self.spec: Spec | None = None
        self._ledger: LiveLedger | None = None
        self._listening: dict[str, Any] = {}
        self._closed = ""
        self._counted, self._told = 0, dict[str, float]()
        self._write = JointStateWriter(TERMS, ["effort"]).bytes
        self._energy = self.create_publisher(JointState, "energy", samples())
        self._diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._recorder = self.create_client(GetParameters, "recorder/get_parameters")
        self.create_subscription(TransitionEvent, "recorder/transition_event", self._follow, 10)
        self.create_service(Trigger, "~/run", self._run)
        self.create_service(Trigger, "~/ready", self._ready)
        self._next_energy, self._next_report = 0.0, 0.0

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Read the spec and listen; analyse the recording that the parameter names, if it is there."""
        try:
            self.spec = spec_of(self, self._besides)
            self.spec.loop()
            rehearse(self.spec)
        except InputError as error:
            self.get_logger().error(str(error))
            return TransitionCallbackReturn.FAILURE
        for topic, kind in TOPICS.items():
            self._listen(topic, JointState if kind == JOINT_STATE else TimeReference)
        if Path(self._value("bag")).exists() and self._value("bag"):
            self._analyse(self._value("bag"))
        return super().on_configure(state)

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Open the books."""
        assert self.spec is not None
        begin = 0 if self._value("virtual") else self._value("start_time")
        self._ledger, self._counted, self._told = LiveLedger(self.spec, begin), 0, {}
        return super().on_activate(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Count what is left and close the books."""
        self._count(final=True)
        self._ledger = None
        return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Stop listening; a new spec can then be set."""
        self._leave()
        return super().on_cleanup(state)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Stop listening."""
        self._leave()
        return super().on_shutdown(state)

    def turn(self) -> None:
        """Serve the executor, and count and report when it is time; called again and again."""
        self.executor.spin_once(timeout_sec=PERIOD / 2)
        now = time.monotonic()
        if self._value("autostart"):
            self._start()
        if now >= self._next_energy:
            self._next_energy = now + PERIOD
            self._count()
        if now >= self._next_report:
            self._next_report = now + 1.0
            self._report()

    def stop(self) -> None:
        """Close the books; the process ends."""
        self._ledger = None

    def _value(self, name: str) -> Any:
        return self.get_parameter(name).value

    def _listen(self, topic: str, kind: type) -> None:
        if topic not in self._listening:
            take = partial(self._take, topic)
            self._listening[topic] = self.create_subscription(kind, topic, take, samples(DEPTH), raw=True)

    def _leave(self) -> None:
        for subscription in self._listening.values():
            self.destroy_subscription(subscription)
        self._listening.clear()
        self.spec = None

    def _take(self, topic: str, message: bytes) -> None:
        if self._ledger is not None:
            self._ledger.take(topic, message)

    def _start(self) -> None:
        """Configure and activate by itself."""
        self.set_parameters([Parameter("autostart", value=False)])
        if self.trigger_configure() == TransitionCallbackReturn.SUCCESS:
            self.trigger_activate()

    def _count(self, *, final: bool = False) -> None:
        """Move the books on and publish them."""
        counted = self._ledger.advance(final=final) if self._ledger is not None else None
        if counted is not None and counted[0] != self._counted:
            self._counted, self._told = counted
            self._energy.publish(self._write(self._counted, [self._told[name] for name in TERMS]))

    def _follow(self, event: TransitionEvent) -> None:
        """Analyse a recording when it closes; its recorder knows where it is."""
        closes = event.start_state.label in ("active", "deactivating")
        if (
            closes
            and event.goal_state.id == State.PRIMARY_STATE_INACTIVE
            and self._recorder.service_is_ready()
        ):
            asked = self._recorder.call_async(GetParameters.Request(names=["bag"]))
            asked.add_done_callback(self._take_over)

    def _take_over(self, answer: Any) -> None:
        values = answer.result().values if answer.result() is not None else []
        if values and values[0].string_value:
            self._closed = values[0].string_value
            self._analyse(self._closed)

    def _run(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Service ``~/run``: analyse the recording of the parameter, or the one that was closed last."""
        bag = self._value("bag") or self._closed
        if bag:
            response.success, response.message = self._analyse(bag)
        else:
            response.message = "no recording is known: set the parameter bag."
        return response

    def _analyse(self, bag: str) -> tuple[bool, str]:
        """Analyse a recording; return whether it worked, and the verdict or the reason in words."""
        try:
            energy, timing = analyse_bag(bag)
            place = write_beside(bag, energy)
        except InputError as error:
            self.get_logger().error(str(error))
            self._tell("verdict", DiagnosticStatus.ERROR, str(error), {"bag": bag})
            return False, str(error)
        facts = verdict(energy, timing)
        level = DiagnosticStatus.WARN if any(fact.level == BAD for fact in facts) else DiagnosticStatus.OK
        words = " ".join(fact.words for fact in facts)
        self._tell(
            "verdict", level, words, {"bag": bag, "energies": place} | {f.label: f.value for f in facts}
        )
        return True, words

    def _ready(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Service ``~/ready``: whether everybody who publishes a state is connected."""
        waiting = [
            topic for topic, subscription in self._listening.items() if not self._matched(topic, subscription)
        ]
        response.success = self.spec is not None and not waiting
        response.message = f"waits for {', '.join(waiting)}" if waiting else "ready"
        return response

    def _matched(self, topic: str, subscription: Any) -> bool:
        known = self.count_publishers(subscription.topic_name)
        needed = 0 if topic.startswith("links/") else 1
        return bool(subscription.get_publisher_count() >= max(needed, known))

    def _report(self) -> None:
        state = self._state_machine.current_state[1]
        terms = {f"{name} [J]": f"{value:.6g}" for name, value in self._told.items()}
        self._tell(
            "energy",
            DiagnosticStatus.OK,
            "keeps the books" if self._ledger else "waits",
            {"state": state} | terms,
        )

    def _tell(self, part: str, level: bytes, message: str, values: dict[str, object]) -> None:
        pairs = [KeyValue(key=key, value=str(value)) for key, value in values.items()]
        name = f"{self.get_fully_qualified_name()}: {part}"
        status = DiagnosticStatus(
            level=level, name=name, message=message, hardware_id=self.get_name(), values=pairs
        )
        array = DiagnosticArray(status=[status])
        array.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(array)


def main() -> int:
    """Run the node until it is asked to end."""
    return run(AnalysisNode)


if __name__ == "__main__":
    sys.exit(main())
