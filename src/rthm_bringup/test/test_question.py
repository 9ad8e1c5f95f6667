from __future__ import annotations

from types import SimpleNamespace

import pytest
from lifecycle_msgs.srv import ChangeState

from rthm_bringup.run.question import ANSWER_LOOKED_FOR, CHANGES, Question, Transition


class Answer:
    """Future that is given its result by hand."""

    def __init__(self) -> None:
        self.value = None

    def done(self) -> bool:
        return self.value is not None

    def result(self) -> object:
        return self.value


class Node:
    """Node that hears some of what it is asked."""

    def __init__(self) -> None:
        self.asked: list[Answer] = []

    def ask(self) -> Answer:
        self.asked.append(Answer())
        return self.asked[-1]


def state(number: int) -> SimpleNamespace:
    return SimpleNamespace(current_state=SimpleNamespace(id=number))


def test_an_answer_is_taken_and_nothing_is_asked_twice():
    node = Node()
    question = Question(node.ask, 0.0)
    assert question.look(0.5 * ANSWER_LOOKED_FOR) is None
    node.asked[0].value = "yes"
    assert question.look(2.0 * ANSWER_LOOKED_FOR) == "yes"
    assert len(node.asked) == 1


def test_a_lost_request_is_asked_again_and_any_answer_counts():
    node = Node()
    question = Question(node.ask, 0.0)
    assert question.look(1.1 * ANSWER_LOOKED_FOR) is None
    assert question.look(1.2 * ANSWER_LOOKED_FOR) is None
    assert len(node.asked) == 2
    node.asked[1].value = "yes"
    assert question.look(1.3 * ANSWER_LOOKED_FOR) == "yes"


def test_what_does_harm_when_done_twice_is_asked_once():
    node = Node()
    assert Question(node.ask, 0.0, float("inf")).look(100.0) is None
    assert len(node.asked) == 1


def transition(node: Node, states: Node) -> Transition:
    return Transition(node.ask, 0.0, states.ask, CHANGES["configure"])


def test_a_transition_whose_answer_was_lost_is_not_asked_for_again():
    node, states = Node(), Node()
    asked = transition(node, states)
    assert asked.look(1.1 * ANSWER_LOOKED_FOR) is None
    states.asked[0].value = state(CHANGES["configure"].after)
    assert asked.look(2.2 * ANSWER_LOOKED_FOR) == ChangeState.Response(success=True)
    assert len(node.asked) == 1


def test_a_transition_that_was_never_heard_of_is_asked_for_again():
    node, states = Node(), Node()
    asked = transition(node, states)
    asked.look(1.1 * ANSWER_LOOKED_FOR)
    states.asked[0].value = state(CHANGES["configure"].before)
    asked.look(2.2 * ANSWER_LOOKED_FOR)
    assert len(node.asked) == 2
    node.asked[1].value = ChangeState.Response(success=True)
    assert asked.look(2.3 * ANSWER_LOOKED_FOR).success


@pytest.mark.parametrize(("now", "done"), [("before", False), ("after", True)])
def test_a_refusal_of_what_was_asked_for_twice_is_believed_when_it_was_not_done(now: str, done: bool):
    node, states, change = Node(), Node(), CHANGES["configure"]
    asked = transition(node, states)
    asked.look(1.1 * ANSWER_LOOKED_FOR)
    states.asked[0].value = state(change.before)
    asked.look(2.2 * ANSWER_LOOKED_FOR)
    node.asked[1].value = ChangeState.Response(success=False)
    assert asked.look(2.3 * ANSWER_LOOKED_FOR) is None
    states.asked[1].value = state(getattr(change, now))
    assert asked.look(3.4 * ANSWER_LOOKED_FOR).success == done
    assert len(node.asked) == 2


def test_a_refusal_of_what_was_asked_for_once_is_the_answer():
    node, states = Node(), Node()
    asked = transition(node, states)
    node.asked[0].value = ChangeState.Response(success=False)
    assert not asked.look(0.5 * ANSWER_LOOKED_FOR).success
    assert not states.asked


def test_a_node_that_is_busy_is_left_in_peace_but_for_its_state():
    node, states = Node(), Node()
    asked = transition(node, states)
    for k in range(1, 8):
        assert asked.look(1.1 * k * ANSWER_LOOKED_FOR) is None
    assert len(node.asked) == 1
