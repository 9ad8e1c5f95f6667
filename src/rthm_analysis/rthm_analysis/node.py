"""Node ``analysis``: the energy ledger of a running test, and the analysis of a recording.

While it is active it listens to the loop, computes the energy balance, and publishes it on ``energy`` ten
times a second. A recording is analysed when the parameter ``bag`` names one, when the service ``~/run`` is
called, and when the recorder closes the one that it was writing: the energies go beside the bag as JSON, the
verdict to ``/diagnostics``. Command line, page and node are the same code.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

from lifecycle_msgs.msg import State, TransitionEvent
from rcl_interfaces.msg import ParameterDescriptor
from rcl_interfaces.srv import GetParameters
from sensor_msgs.msg import JointState, TimeReference
from std_srvs.srv import Trigger

from rthm_analysis.bag_analysis import analyse_bag, write_beside
from rthm_analysis.energy import rehearse
from rthm_analysis.live import TOPICS, LiveLedger
from rthm_analysis.report.verdict import BAD, verdict
from rthm_core.errors import InputError
from rthm_core.ros import system
from rthm_core.ros.diagnostics import ERROR, OK, WARN, Diagnostics
from rthm_core.ros.managed import ManagedNode
from rthm_core.ros.messages import JointStateWriter
from rthm_core.ros.polling import Mailbox
from rthm_core.ros.process import run
from rthm_core.ros.qos import samples
from rthm_core.spec import Spec
from rthm_core.topics import JOINT_STATE, link_topic

ENERGY_PERIOD = 0.1
"""Between two messages on ``energy``, s."""

DEPTH = 1000
"""Samples of a topic that wait while the node is busy: about a second of the fastest one."""

TERMS = (
    "E_num", "E_ff", "E_fx", "E_err", "E_damping", "E_load", "E_effects", "E_total", "balance_error",
)  # fmt: skip
"""Names on ``energy``."""


class AnalysisNode(ManagedNode):
    """Listens, counts, tells."""

    further: ClassVar[tuple[str, ...]] = ("bag",)

    def __init__(self) -> None:
        super().__init__("analysis")
        words = "recording to analyse; empty: the one that the recorder has closed"
        self.declare_parameter("bag", "", ParameterDescriptor(description=words))
        self._ledger: LiveLedger | None = None
        self._mailboxes: dict[str, Mailbox] = {}
        self._closed = self._analysed = ""
        self._counted, self._told = 0, dict[str, float]()
        self._write = JointStateWriter(TERMS, ["effort"]).bytes
        self._energy = self.create_publisher(JointState, "energy", samples())
        self.diagnostics = Diagnostics(self)
        self._recorder = self.create_client(GetParameters, "recorder/get_parameters")
        self.create_subscription(TransitionEvent, "recorder/transition_event", self._follow, 10)
        self.create_service(Trigger, "~/run", self._run)
        self.create_service(Trigger, "~/ready", self._ready)
        self._next_energy, self._next_report, self._tried = 0.0, 0.0, False

    def configure(self, spec: Spec) -> None:
        """Listen to the loop."""
        rehearse(spec)
        if self.value("virtual"):
            system.prepare_virtual()
        for topic, kind in TOPICS.items():
            message = JointState if kind == JOINT_STATE else TimeReference
            self._mailboxes[topic] = Mailbox(self, message, topic, samples(DEPTH))

    def activate(self, spec: Spec) -> None:
        """Open the balance."""
        begin = 0 if self.value("virtual") else self.value("start_time")
        self._ledger, self._counted, self._told = LiveLedger(spec, begin), 0, {}

    def deactivate(self) -> None:
        """Count what is left and close the balance."""
        self._take()
        self._count(final=True)
        self._ledger = None

    def release(self) -> None:
        """Leave all topics."""
        for mailbox in self._mailboxes.values():
            mailbox.close()
        self._mailboxes.clear()

    def turn(self) -> None:
        """Serve the executor, and count and report when it is time; called again and again."""
        self.executor.spin_once(timeout_sec=ENERGY_PERIOD / 2)
        self._take()
        now = time.monotonic()
        if now >= self._next_energy:
            self._next_energy = now + ENERGY_PERIOD
            self._count()
        if now >= self._next_report:
            self._next_report = now + 1.0
            self._autostart()
            self._analyse_named()
            self._report()

    def _autostart(self) -> None:
        """Configure and activate by itself, once."""
        if self.value("autostart") and self.spec is None and not self._tried:
            self._tried = True
            self.trigger_configure()
            if self.spec is not None:
                self.trigger_activate()

    def _take(self) -> None:
        """Keep what has arrived; outside of a test nothing of it is needed."""
        for topic, mailbox in self._mailboxes.items():
            for message, _ in mailbox.take():
                if self._ledger is not None:
                    self._ledger.take(topic, message)

    def _count(self, *, final: bool = False) -> None:
        """Carry the balance on and publish it."""
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

    def _analyse_named(self) -> None:
        """Analyse the recording of the parameter, once, when it is complete."""
        bag = self.value("bag")
        complete = Path(bag).is_file() or (Path(bag) / "metadata.yaml").is_file()
        if bag and bag != self._analysed and complete and not self.active:
            self._analyse(bag)

    def _run(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Service ``~/run``: analyse the recording of the parameter, or the one that was closed last."""
        bag = self.value("bag") or self._closed
        if bag:
            response.success, response.message = self._analyse(bag)
        else:
            response.message = "no recording is known: set the parameter bag."
        return response

    def _analyse(self, bag: str) -> tuple[bool, str]:
        """Analyse a recording; return whether it worked, and the verdict or the reason in words."""
        self._analysed = bag
        try:
            energy, timing = analyse_bag(bag)
            place = write_beside(bag, energy)
        except InputError as error:
            self.get_logger().error(str(error))
            self._tell("verdict", ERROR, str(error), {"bag": bag})
            return False, str(error)
        facts = verdict(energy, timing)
        level = WARN if any(fact.level == BAD for fact in facts) else OK
        words = " ".join(fact.words for fact in facts)
        self._tell(
            "verdict", level, words, {"bag": bag, "energies": place} | {f.label: f.value for f in facts}
        )
        return True, words

    def _ready(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Service ``~/ready``: whether everybody who publishes a state is connected."""
        waiting = [
            topic
            for topic, box in self._mailboxes.items()
            if not box.matched(0 if link_topic("") in topic else 1)
        ]
        response.success = self.spec is not None and not waiting
        response.message = f"waits for {', '.join(waiting)}" if waiting else "ready"
        return response

    def _report(self) -> None:
        terms = {f"{name} [J]": f"{value:.6g}" for name, value in self._told.items()}
        self._tell("energy", OK, "computes the energy balance" if self.active else "waits", terms)

    def _tell(self, part: str, level: bytes, message: str, values: Mapping[str, object]) -> None:
        self.diagnostics.publish(time.time_ns(), self.diagnostics.status(part, level, message, values))


def main() -> int:
    """Run the node until it is asked to end."""
    return run(AnalysisNode)


if __name__ == "__main__":
    sys.exit(main())
