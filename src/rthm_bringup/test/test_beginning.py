from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from types import SimpleNamespace

import pytest

from rthm_bringup.run import beginning
from rthm_bringup.run.question import ACTIVE, INACTIVE
from rthm_bringup.run.stopped import RefusedError, StoppedError
from rthm_core.clock import NS

NAMES = ("plant", "numerical", "actuator", "analysis", "recorder")


class Nodes:
    """Nodes with a clock of their own, which refuse to begin at an instant that has passed.

    The `slow` one takes so many s to answer, each time that it is asked.
    """

    def __init__(self, slow: str = "", busy: Iterable[float] = ()) -> None:
        self.slow, self.busy, self.clock = slow, list(busy), 1000 * NS
        self.begin, self.now = dict.fromkeys(NAMES, 0), dict.fromkeys(NAMES, INACTIVE)
        self.deactivated: list[str] = []

    def set(self, parameters: Mapping[str, Mapping[str, int]]) -> None:
        for name, values in parameters.items():
            assert self.now[name] == INACTIVE
            self.begin[name] = values["start_time"]

    def states(self, names: Iterable[str]) -> dict[str, int]:
        return {name: self.now[name] for name in names}

    def step(self, step: str, names: Iterable[str]) -> None:
        if step == "deactivate":
            for name in names:
                self.now[name] = INACTIVE
                self.deactivated.append(name)
            return
        refused = []
        for name in names:
            if name == self.slow and self.busy:
                self.clock += int(self.busy.pop(0) * NS)
            if self.clock > self.begin[name]:
                refused.append(name)
            else:
                self.now[name] = ACTIVE
        if refused:
            raise RefusedError(f"{refused[0]} refused to activate", refused[0])


Begin = Callable[..., int]


@pytest.fixture
def begun(monkeypatch: pytest.MonkeyPatch) -> Begin:
    """Begin of a test of such nodes."""

    def begin(nodes: Nodes, late: Callable[[str], None] = lambda sentence: None) -> int:
        monkeypatch.setattr(beginning, "time", SimpleNamespace(time_ns=lambda: nodes.clock))
        return beginning.begin_together(nodes, NAMES, 2.0, int, late)

    return begin


def test_all_nodes_begin_at_one_instant(begun: Begin) -> None:
    nodes = Nodes()
    begin = begun(nodes)
    assert begin == nodes.clock + NS
    assert set(nodes.begin.values()) == {begin}
    assert set(nodes.now.values()) == {ACTIVE}
    assert not nodes.deactivated


@pytest.mark.parametrize(
    ("slow", "in_time"),
    [("actuator", ["numerical", "plant"]), ("recorder", ["actuator", "numerical", "plant", "analysis"])],
)
def test_a_begin_that_one_node_misses_is_put_off_for_all(begun: Begin, slow: str, in_time: list[str]) -> None:
    nodes, said = Nodes(slow, [1.2]), list[str]()
    begin = begun(nodes, said.append)
    assert set(nodes.begin.values()) == {begin}
    assert set(nodes.now.values()) == {ACTIVE}
    assert len(said) == 1
    assert nodes.deactivated == in_time  # motors come to rest while the plant still moves


def test_nodes_that_are_late_every_time_end_the_run_with_a_sentence(begun: Begin) -> None:
    with pytest.raises(StoppedError, match="too busy"):
        begun(Nodes("plant", [1.2, 4.5, 17.0]))


def test_a_refusal_for_another_reason_is_told_at_once(begun: Begin) -> None:
    nodes = Nodes()

    def refuse(step: str, names: Iterable[str]) -> None:
        raise RefusedError("plant refused to activate", "plant")

    nodes.step = refuse  # type: ignore[method-assign]
    with pytest.raises(RefusedError, match="plant refused"):
        begun(nodes)
