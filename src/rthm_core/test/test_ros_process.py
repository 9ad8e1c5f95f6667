"""Nodes that share a process: what is due first is done first, in the event order of the contract."""

from __future__ import annotations

from rthm_core.clock import Rank
from rthm_core.ros.agenda import NEVER, Position
from rthm_core.ros.process import take_turn


class Worker:
    """Does things at some places, and notes when it attends to what can wait."""

    def __init__(self, name: str, done: list[str], *places: tuple[int, int], calm: bool = True) -> None:
        self.name, self.done, self.places, self.calm = name, done, list(places), calm

    def next(self) -> Position:
        return Position(*self.places[0]) if self.places else Position(NEVER, 0)

    def turn(self) -> bool:
        self.done.append(f"{self.name} {self.places.pop(0)[0]}")
        return self.calm

    def attend(self) -> None:
        self.done.append(f"{self.name} attends")

    def stop(self) -> None:
        raise AssertionError("nobody asked for it")


def test_the_node_whose_event_comes_first_has_its_turn() -> None:
    done: list[str] = []
    control = Worker("control", done, (0, Rank.CONTROL), (4, Rank.CONTROL), calm=False)
    numerical = Worker("numerical", done, (0, Rank.NUMERICAL), (12, Rank.NUMERICAL), calm=False)
    for _ in range(4):
        take_turn([control, numerical])
    assert done == ["numerical 0", "control 0", "control 4", "numerical 12"]


def test_all_nodes_say_that_they_live_when_one_has_time() -> None:
    done: list[str] = []
    take_turn([Worker("a", done, (1, 0)), Worker("b", done)])
    assert done == ["a 1", "a attends", "b attends"]
