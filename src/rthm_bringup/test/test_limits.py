"""What the leader watches on the graph."""

from __future__ import annotations

import pytest

from rthm_actuator.supervision import Broken
from rthm_bringup.run.limits import EVERY, ClockWatch, OwnerWatch
from rthm_core.clock import NS
from rthm_core.clocks import Exchange, Offset


def test_a_second_publisher_breaks_the_limit_owner() -> None:
    watch = OwnerWatch(lambda: {"plant/state": ["/rthm/plant", "/rthm/other"]})
    words = "plant/state has 2 publishers, /rthm/other and /rthm/plant, but must have one"
    assert watch.broken() == Broken("owner", 2, 1, words)


def test_the_graph_is_looked_at_fifty_times_a_second_whoever_asks() -> None:
    time, looks = [0.0], []
    watch = OwnerWatch(lambda: looks.append(time[0]) or {}, now=lambda: time[0])
    for step in range(500):
        time[0] = step / 512
        assert watch.broken() is None
    assert EVERY == 0.02
    assert 46 <= len(looks) <= 50


def clocks(offset: float, limit: float, told: list[dict[str, Offset]], time: list[float]) -> ClockWatch:
    """Watch over a node whose clock leads by `offset`, s, and one that does not answer."""

    def ask() -> None:
        at, lead = round(time[0] * NS), round(offset * NS)
        watch.take("plant", Exchange(at, at + lead + 100_000, at + lead + 100_000, at + 200_000))
        watch.take("stranger", Exchange(at, at + NS, at + NS, at + 200_000))

    watch = ClockWatch(("plant", "driver"), limit, ask, told.append, now=lambda: time[0])
    return watch


def test_an_offset_beyond_the_limit_is_told_with_both_figures_and_the_way_out() -> None:
    watch = clocks(-0.003, 0.0004, [], [1.0])
    assert watch.broken() is None
    watch.look()
    broken = watch.broken()
    assert broken is not None
    assert (broken.limit, broken.allowed) == ("clock", 0.0004)
    assert broken.value == pytest.approx(0.003)
    assert broken.words.startswith(
        "the clock of plant is 3.000 ms (+- 0.100 ms) behind this host's, but may be 0.4"
    )
    assert "--allow-clock-offset" in broken.words


def test_an_offset_within_the_limit_is_told_twice_a_second_and_breaks_nothing() -> None:
    told: list[dict[str, Offset]] = []
    time = [0.0]
    watch = clocks(0.0003, 0.0004, told, time)
    for step in range(1000):
        time[0] = step * 0.01
        watch.look()
        assert watch.broken() is None
    assert len(told) == 20
    assert set(watch.offsets) == {"plant"}
    assert watch.offsets["plant"].offset == pytest.approx(0.0003)
