"""Node ``coordinator``: lets simulated time pass, window by window, once it is active.

How far the test has come is published as seconds of simulated time on ``virtual/time`` some times a
second, and at the end, when it is the duration of the test.
"""

from __future__ import annotations

import sys
import time
from contextlib import suppress
from typing import Any

import rclpy
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from std_msgs.msg import Float64, Int64MultiArray
from std_srvs.srv import Trigger

from rthm_bringup.run.lockstep import LockStep
from rthm_core.clock import NS, to_ns
from rthm_core.errors import InputError
from rthm_core.ros import system
from rthm_core.ros.grants import DONE, PARTS, Done, grant_to
from rthm_core.ros.managed import refuse_impossible_transitions
from rthm_core.ros.process import built, serving
from rthm_core.ros.qos import latched, samples
from rthm_core.spec import read_spec
from rthm_core.topics import NAMESPACE

TIME = "virtual/time"
"""Topic with the simulated time, in s."""
GRANT_AGAIN = 1.0
"""Wall-clock time after which a grant that is not answered is repeated, s."""


class Coordinator(LifecycleNode):  # type: ignore[misc]
    """Lifecycle node around `LockStep`."""

    def __init__(self) -> None:
        super().__init__("coordinator", namespace=NAMESPACE)
        refuse_impossible_transitions(self)
        self.declare_parameter("spec_file", "")
        self.declare_parameter("start_time", 0)
        self.declare_parameter("duration", 0.0)
        self.declare_parameter("observers", ["recorder"])
        self._grants = {
            part: self.create_publisher(Int64MultiArray, grant_to(part), samples()) for part in PARTS
        }
        self._time = self.create_publisher(Float64, TIME, latched())
        self.create_subscription(Int64MultiArray, DONE, self._hear, samples(), raw=True)
        self.create_service(Trigger, "~/ready", self._ready)
        self.create_service(Trigger, "~/stand", self._stand)
        self._greetings: dict[int, Done] = {}
        self._step: LockStep | None = None
        self._told = self._moved = 0.0

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Let time pass as soon as every part has greeted."""
        try:
            spec = read_spec(self._value("spec_file"))
            self._step = LockStep(spec, to_ns(self._value("duration")), self._observers())
        except InputError as error:
            self.get_logger().error(str(error))
            return TransitionCallbackReturn.FAILURE
        for greeting in self._greetings.values():
            self._step.hear(greeting)
        self._move()
        return super().on_activate(state)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Let time stand."""
        self._step = None
        self._greetings.clear()
        return super().on_deactivate(state)

    def watch(self) -> None:
        """Say how far the test has come, and repeat what somebody has not answered."""
        now = time.monotonic()
        if self._step is None or now < self._told + 0.1:
            return
        self._told = now
        finished = self._step.finished
        self._time.publish(Float64(data=self._value("duration") if finished else self._step.reached / NS))
        if now > self._moved + GRANT_AGAIN and not finished:
            self._moved = now
            self._repeat()

    def _hear(self, data: bytes) -> None:
        done = Done.read(data)
        if self._step is None:
            self._greetings[done.part] = done
        else:
            self._step.hear(done)
            self._move()

    def _move(self) -> None:
        assert self._step is not None
        grants = self._step.advance()
        for part, grant in grants.items():
            self._grants[part].publish(grant.message())
        if grants:
            self._moved = time.monotonic()

    def _repeat(self) -> None:
        assert self._step is not None
        silent = self._step.silent()
        self.get_logger().warning(f"waits for {' and '.join(silent)}")
        for part, grant in silent.items():
            if grant.round:
                self._grants[part].publish(grant.message())

    def _observers(self) -> list[str]:
        return [name for name in self._value("observers") if name]

    def _ready(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        wanted = [*PARTS[:3], *self._observers()]
        absent = [part for part in wanted if not self._grants[part].get_subscription_count()]
        response.success = not absent and self.count_publishers(DONE) >= len(wanted)
        response.message = f"waits for {', '.join(absent) or 'answers'}"
        return response

    def _stand(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Service ``~/stand``: let time stand; whether all that was sent has been recorded."""
        response.success = True
        if self._step is not None:
            self._step.stopping = True
            self._move()
            response.success = self._step.settled
            response.message = f"waits for {' and '.join(self._step.silent())}"
        return response

    def _value(self, name: str) -> Any:
        return self.get_parameter(name).value


def main() -> int:
    """Run the node until it is asked to end."""
    rclpy.init()
    node = built(Coordinator)
    with serving(node) as executor, suppress(KeyboardInterrupt):
        system.prepare_virtual()
        while rclpy.ok():
            executor.spin_once(timeout_sec=0.1)
            node.watch()
    return 0


if __name__ == "__main__":
    sys.exit(main())
