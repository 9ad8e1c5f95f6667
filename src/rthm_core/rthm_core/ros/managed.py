"""A lifecycle node around a spec: transitions never raise, and parameters change only when they may."""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable
from typing import Any, ClassVar

from lifecycle_msgs.srv import ChangeState
from rcl_interfaces.msg import SetParametersResult
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter

from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.ros import leader
from rthm_core.ros.comparing import Clock
from rthm_core.ros.parameters import OWN, declare_own, declare_spec, spec_of
from rthm_core.ros.polling import PollingNode
from rthm_core.ros.wall import wall_ns
from rthm_core.spec import Spec
from rthm_core.topics import NAMESPACE


def refuse_impossible_transitions(node: LifecycleNode) -> None:
    """Refuse a transition that the present state of `node` does not have; rclpy would raise, and end it."""
    service = node._service_change_state
    transit = service.callback

    def attempt(request: ChangeState.Request, response: ChangeState.Response) -> ChangeState.Response:
        try:
            return transit(request, response)
        except rclpy_implementation.RCLError as error:
            node.get_logger().error(str(error))
            response.success = False
            return response

    service.callback = attempt


def refuse_past(start: int) -> None:
    """Refuse to begin at an instant of the wall clock (ns; 0: any) that has passed, with an InputError."""
    ago = (wall_ns() - start) / NS
    if start and ago > 0.0:
        raise InputError(f"start_time is {start}, {ago:.3f} s ago, but must lie ahead; set a later one.")


class ManagedNode(PollingNode):
    """Lifecycle node; what it does in a transition is `configure`, `activate`, `deactivate` and `release`.

    A transition fails with one sentence in the log when one of them raises `InputError`.

    Attributes
    ----------
    spec
        What the node is configured with; None while it is not.
    active
        Whether a test is going on.
    further
        Names of parameters of this kind of node beside the spec's and `OWN`; the node declares them itself.
    """

    further: ClassVar[tuple[str, ...]] = ()

    def __init__(self, name: str) -> None:
        super().__init__(name, namespace=NAMESPACE, allow_undeclared_parameters=True)
        leader.answer_only_to_leader(self)
        self._besides = {*self._parameters, *OWN, *self.further}
        declare_own(self)
        declare_spec(self, self._besides)
        self.spec: Spec | None = None
        self.active = False
        refuse_impossible_transitions(self)
        self.add_on_set_parameters_callback(self._check_change)
        self._told_clock = Clock(self, lambda: self.wall_ns() - time.time_ns())

    def configure(self, spec: Spec) -> None:
        """Get ready for tests of this spec."""

    def activate(self, spec: Spec) -> None:
        """Begin a test."""

    def deactivate(self) -> None:
        """End the test."""

    def release(self) -> None:
        """Let go of everything that `configure` took, also if it did not come to its end."""

    def wall_ns(self) -> int:
        """Nanoseconds since 1970, by the clock of this node."""
        return wall_ns()

    def value(self, name: str) -> Any:
        """Value of one of the node's own parameters."""
        return self.get_parameter(name).value

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Read the spec from the parameters."""
        done = self._attempt(self._configure)
        if done != TransitionCallbackReturn.SUCCESS:
            self._release()
        return done

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Begin a test."""
        return self._attempt(self._activate)

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """End the test."""
        return self._attempt(self.stop)

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Forget the spec; another one can then be set."""
        return self._attempt(self._release)

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """End whatever goes on."""
        self._attempt(self.stop)
        return self._attempt(self._release)

    def stop(self) -> None:
        """End the test, if one is going on."""
        if self.active:
            self.deactivate()
        self.active = False

    def _configure(self) -> None:
        spec = spec_of(self, self._besides)
        self.configure(spec)
        self.spec = spec

    def _activate(self) -> None:
        assert self.spec is not None
        if not self.value("virtual"):
            refuse_past(self.value("start_time"))
        self.activate(self.spec)
        self.active = True

    def _release(self) -> None:
        self.release()
        self.spec = None

    def _attempt(self, step: Callable[[], None]) -> TransitionCallbackReturn:
        """Do a step of a transition; rclpy would swallow what it raises."""
        try:
            step()
        except InputError as error:
            self.get_logger().error(str(error))
            return TransitionCallbackReturn.FAILURE
        except Exception:
            self.get_logger().fatal(traceback.format_exc())
            return TransitionCallbackReturn.ERROR
        return TransitionCallbackReturn.SUCCESS

    def _check_change(self, changes: list[Parameter]) -> SetParametersResult:
        for change in changes:
            if self.active and change.name != leader.PARAMETER:
                return _refused(change, "before the node is activated")
            if self.spec is not None and change.name not in self._besides:
                return _refused(change, "before the node is configured")
        return SetParametersResult(successful=True)


def _refused(change: Parameter, when: str) -> SetParametersResult:
    return SetParametersResult(successful=False, reason=f"{change.name} can be changed only {when}")
