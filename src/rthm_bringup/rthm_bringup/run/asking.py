"""Services of the nodes of a test: several are asked at once, and asked again where an answer got lost."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from std_srvs.srv import Trigger

from rthm_bringup.run.question import ANSWER_LOOKED_FOR, CHANGES, Question, Transition
from rthm_core.errors import InputError

SERVICES = {"change_state": ChangeState, "get_state": GetState, "set_parameters": SetParameters}
"""Types of services; all others are triggers."""

LONG = "run"
"""Service that takes long, and would be done twice if it were asked for twice."""

WaitUntil = Callable[[Callable[[], bool], float, Callable[[], str]], None]
"""Waits for a condition, so many seconds, or says why not."""


class Services:
    """Clients of the services of all nodes of a test.

    Parameters
    ----------
    node : rclpy.node.Node
        Whose clients they are.
    namespace : str
        Of the nodes that are asked.
    wait_until
        Serves the node until a condition is met (`Conductor.wait_until`).
    """

    def __init__(self, node: Any, namespace: str, wait_until: WaitUntil) -> None:
        self._node, self._namespace, self._wait_until = node, namespace, wait_until
        self._clients: dict[tuple[str, str], Any] = {}

    def ask(
        self, requests: Mapping[str, Any], service: str, seconds: float, step: str = ""
    ) -> dict[str, Any]:
        """Ask several nodes at once, as soon as they can be asked; return their answers."""
        clients = {name: self.client(name, service) for name in requests}

        def deaf() -> list[str]:
            return [name for name, client in clients.items() if not client.service_is_ready()]

        self._wait_until(
            lambda: not deaf(),
            seconds,
            lambda: f"{' and '.join(deaf())} did not offer {service} within {seconds:g} s.",
        )
        questions = {name: self._question(name, service, request, step) for name, request in requests.items()}

        def silent() -> list[str]:
            return [name for name, one in questions.items() if one.look(time.monotonic()) is None]

        self._wait_until(
            lambda: not silent(),
            seconds,
            lambda: f"{' and '.join(silent())} did not answer within {seconds:g} s.",
        )
        return {name: one.answer for name, one in questions.items()}

    def _question(self, name: str, service: str, request: Any, step: str) -> Question:
        """Ask one node; `step` is the transition that is asked for, if it is one."""
        ask, now = partial(self.client(name, service).call_async, request), time.monotonic()
        if not step:
            return Question(ask, now, float("inf") if service == LONG else ANSWER_LOOKED_FOR)
        state = partial(self.client(name, "get_state").call_async, GetState.Request())
        return Transition(ask, now, state, CHANGES[step])

    def client(self, name: str, service: str) -> Any:
        """Client of a service of a node, made once."""
        if (name, service) not in self._clients:
            kind = SERVICES.get(service, Trigger)
            self._clients[name, service] = self._node.create_client(
                kind, f"{self._namespace}/{name}/{service}"
            )
        return self._clients[name, service]


def parameter(name: str, value: Any) -> Parameter:
    """A parameter as a message; a tuple is a list of numbers.

    Raises
    ------
    InputError
        When no type of parameter holds the value.
    """
    kinds = {
        bool: (ParameterType.PARAMETER_BOOL, "bool_value"),
        int: (ParameterType.PARAMETER_INTEGER, "integer_value"),
        float: (ParameterType.PARAMETER_DOUBLE, "double_value"),
        str: (ParameterType.PARAMETER_STRING, "string_value"),
        list: (ParameterType.PARAMETER_STRING_ARRAY, "string_array_value"),
        tuple: (ParameterType.PARAMETER_DOUBLE_ARRAY, "double_array_value"),
    }
    if type(value) not in kinds:
        raise InputError(f"{name} is {value!r}, which is not a value of a parameter.")
    kind, member = kinds[type(value)]
    return Parameter(name=name, value=ParameterValue(type=kind, **{member: value}))
