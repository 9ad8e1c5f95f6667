"""What the leader watches on the graph."""

from __future__ import annotations

from rthm_bringup.run.limits import EVERY, Broken, OwnerWatch


def test_a_second_publisher_breaks_the_limit_owner() -> None:
    watch = OwnerWatch(lambda: {"plant/state": ["/rthm/plant", "/rthm/other"]})
    words = "plant/state has 2 publishers, /rthm/other and /rthm/plant, but must have one."
    assert watch.broken() == Broken("owner", 2, 1, words)


def test_the_graph_is_looked_at_ten_times_a_second_whoever_asks() -> None:
    time, looks = [0.0], []
    watch = OwnerWatch(lambda: looks.append(time[0]) or {}, now=lambda: time[0])
    for step in range(100):
        time[0] = step * EVERY / 10.0
        assert watch.broken() is None
    assert len(looks) == 10
