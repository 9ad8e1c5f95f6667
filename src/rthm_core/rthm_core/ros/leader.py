"""A node in a test answers only to the leader of the test.

Anybody on the graph can call ``change_state``, and read parameters. So the leader locks a node with the hash
of a word that it alone knows (parameter ``leader``) before it activates it. While the node is active,
transitions are refused to everybody until the word itself is set. A lock whose leader has left the graph
holds nobody back.
"""

from __future__ import annotations

import hashlib
import secrets

from lifecycle_msgs.msg import State
from lifecycle_msgs.srv import ChangeState
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.lifecycle import LifecycleNode
from rclpy.parameter import Parameter

PARAMETER = "leader"
"""Name of the parameter that locks and unlocks a node."""

NODE = "run"
"""Name of the leader's node."""

_WORDS = "lock of the leader of the test; while the node is active, only who has set it can change its state"


def new_word() -> str:
    """A word that nobody can guess."""
    return secrets.token_hex(16)


def lock_of(word: str) -> str:
    """What a node may know about a word, to recognise it."""
    return hashlib.sha256(word.encode()).hexdigest()


def may_set(active: bool, lock: str, value: str) -> bool:
    """Whether the lock of a node may be replaced by `value`: always outside of a test, then by its word."""
    return not active or not lock or lock_of(value) == lock


def is_closed(lock: str) -> bool:
    """Whether a value of the parameter is a lock rather than the word that opened one."""
    return len(lock) == hashlib.sha256().digest_size * 2


def answer_only_to_leader(node: LifecycleNode) -> None:
    """Lock the transitions of `node` as its leader asks for."""
    node.declare_parameter(PARAMETER, "", ParameterDescriptor(description=_WORDS))
    service = node._service_change_state
    transit = service.callback

    def attempt(request: ChangeState.Request, response: ChangeState.Response) -> ChangeState.Response:
        if _active(node) and is_closed(_lock(node)) and _has_leader(node):
            node.get_logger().warning(
                "refused to change its state: a test runs, and only its leader may end it"
            )
            response.success = False
            return response
        return transit(request, response)

    def check(changes: list[Parameter]) -> SetParametersResult:
        refused = any(
            change.name == PARAMETER and not may_set(_active(node), _lock(node), str(change.value))
            for change in changes
        )
        reason = f"{PARAMETER} can be changed only by the leader of the test" if refused else ""
        return SetParametersResult(successful=not refused, reason=reason)

    service.callback = attempt
    node.add_on_set_parameters_callback(check)


def _active(node: LifecycleNode) -> bool:
    return bool(node._state_machine.current_state[0] == State.PRIMARY_STATE_ACTIVE)


def _lock(node: LifecycleNode) -> str:
    return str(node.get_parameter(PARAMETER).value)


def _has_leader(node: LifecycleNode) -> bool:
    return (NODE, node.get_namespace()) in node.get_node_names_and_namespaces()
