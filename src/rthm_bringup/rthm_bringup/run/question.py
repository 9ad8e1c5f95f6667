"""A request to one node, asked again when it or its answer got lost.

A node that has only just been discovered may not yet know who asks it: then the middleware drops what it is
asked, or has nobody to send the answer to, and tells neither side. Waiting does not help; asking again does.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

from lifecycle_msgs import msg as lifecycle
from lifecycle_msgs.srv import ChangeState

ANSWER_LOOKED_FOR = 3.0
"""How long the answer to what is done in an instant may stay out before it is looked for, s."""


class Future(Protocol):
    """Answer to come."""

    def done(self) -> bool:
        """Whether it has come."""

    def result(self) -> Any:
        """Return it."""


class Change(NamedTuple):
    """A transition of a lifecycle node, and its states before and after it."""

    number: int
    before: int
    after: int


UNCONFIGURED = lifecycle.State.PRIMARY_STATE_UNCONFIGURED
INACTIVE = lifecycle.State.PRIMARY_STATE_INACTIVE
ACTIVE = lifecycle.State.PRIMARY_STATE_ACTIVE

CHANGES = {
    "configure": Change(lifecycle.Transition.TRANSITION_CONFIGURE, UNCONFIGURED, INACTIVE),
    "activate": Change(lifecycle.Transition.TRANSITION_ACTIVATE, INACTIVE, ACTIVE),
    "deactivate": Change(lifecycle.Transition.TRANSITION_DEACTIVATE, ACTIVE, INACTIVE),
    "cleanup": Change(lifecycle.Transition.TRANSITION_CLEANUP, INACTIVE, UNCONFIGURED),
}


class Question:
    """A request to a node.

    Parameters
    ----------
    ask
        Sends the request.
    now
        Time at which it is asked first, s.
    again
        How long an answer may stay out before it is asked again, s; infinite for what must not be done twice.

    Attributes
    ----------
    answer
        What the node answered; None: nothing yet.
    """

    def __init__(self, ask: Callable[[], Future], now: float, again: float = ANSWER_LOOKED_FOR) -> None:
        self.answer: Any = None
        self._ask, self._asked, self._again = ask, now, again
        self._futures = [ask()]

    def look(self, now: float) -> Any:
        """Return the answer if there is one; ask again if it is overdue."""
        if self.answer is None:
            self.answer = next((one.result() for one in self._futures if one.done()), None)
        if self.answer is None and now > self._asked + self._again:
            self._asked = now
            self._overdue()
        return self.answer

    def _overdue(self) -> None:
        self._futures.append(self._ask())


class Transition(Question):
    """A request for a transition, which a node would refuse the second time: first its state is asked for.

    Parameters
    ----------
    state
        Asks the node for its state.
    change
        What the transition does to the state.
    """

    def __init__(
        self, ask: Callable[[], Future], now: float, state: Callable[[], Future], change: Change
    ) -> None:
        super().__init__(ask, now)
        self._state, self._change = state, change
        self._states: list[Future] = []
        self._refusal: Any = None

    def look(self, now: float) -> Any:
        """Return the answer; a refusal of what was asked for twice is believed when the state agrees."""
        answer = super().look(now)
        if answer is not None and not answer.success and len(self._futures) > 1 and self._refusal is None:
            self.answer, self._refusal, self._futures = None, answer, []
            self._states = [self._state()]
        return self.answer

    def _overdue(self) -> None:
        told = [one.result().current_state.id for one in self._states if one.done()]
        self._states = [] if told else self._states
        if self._change.after in told:
            self.answer = ChangeState.Response(success=True)
        elif self._change.before in told and self._refusal is None:
            self._futures.append(self._ask())
        elif self._change.before in told:
            self.answer = self._refusal
        else:
            self._states.append(self._state())
