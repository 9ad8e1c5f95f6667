"""Links: order, loss, and that every process draws the same."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from rthm_core.link import NEVER, Inbox, Link
from rthm_core.schedule import Schedule, newest, newest_arrived
from rthm_core.spec import apply, shipped_spec


def jittered(std, loss=0.0):
    effects = {"effects": ["shaky", "lossy"], "shaky": {"block": "link.tau1", "kind": "jitter", "std": std}}
    return apply(
        shipped_spec("paper"), effects | {"lossy": {"block": "link.tau1", "kind": "loss", "fraction": loss}}
    )


@settings(max_examples=30)
@given(std=st.floats(0.0, 0.02), loss=st.floats(0.0, 0.5))
def test_a_receiver_never_goes_back_to_an_older_sample(std, loss):
    uses = np.arange(500, dtype=np.int64) * 4_000_000
    held = newest(Link(jittered(std, loss), "tau1"), 1_200_000, uses)
    assert (np.diff(held) >= 0).all()
    assert (held * 1_200_000 <= uses).all()


@settings(max_examples=30)
@given(std=st.floats(1e-4, 0.01), loss=st.floats(0.0, 0.5))
def test_inbox_holds_what_the_schedule_says(std, loss):
    link, inbox, period = Link(jittered(std, loss), "tau1"), Inbox(), 1_200_000
    uses = np.arange(100, dtype=np.int64) * 4_000_000
    expected = newest(link, period, uses)
    for number in range(int(uses[-1]) // period + 1):
        inbox.push(number * period, link.due(number * period), number)
    held = []
    for use in uses:
        taken = inbox.take(int(use))
        held.append(taken[1] if taken else held[-1] if held else -1)
    np.testing.assert_array_equal(held, expected)


def test_due_times_are_the_same_one_by_one_and_together():
    link = Link(jittered(0.003, 0.2), "tau1")
    stamps = np.arange(200, dtype=np.int64) * 1_200_000
    together = link.due_all(stamps)
    assert [link.due(int(stamp)) for stamp in stamps] == [
        None if due == NEVER else due for due in together.tolist()
    ]
    assert 0.1 < np.mean(together == NEVER) < 0.3


@given(
    st.lists(st.integers(0, 1000), min_size=1, max_size=40),
    st.lists(st.integers(0, 1200), min_size=1, max_size=20),
)
def test_newest_arrived_is_the_largest_number_that_is_due(due, uses):
    numbers = np.arange(len(due), dtype=np.int64)
    found = newest_arrived(numbers, np.array(due), np.sort(np.array(uses)))
    expected = [max([k for k in numbers if due[k] <= use], default=-1) for use in sorted(uses)]
    np.testing.assert_array_equal(found, expected)


def test_hold_and_delay_add_up_as_facts_say():
    """With all clocks in phase the effective paths are 16.4 / 36.4 / 14.4 ms (state by tau1, by tau2 and
    tau3, reference)."""
    schedule = Schedule(shipped_spec("paper"))
    commands = schedule.commands(600_000_000, 12_600_000_000)
    until = np.append(commands.time[1:], 12_600_000_000)

    def mean_age(stamp):
        width = until - commands.time
        return float((width * (0.5 * (until + commands.time) - stamp)).sum() / width.sum()) * 1e-6 + 10.0

    assert abs(mean_age(commands.state * schedule.td1) - 16.4) < 0.01
    _, state = schedule.references(0, 13_000_000_000)
    assert abs(mean_age(state[commands.reference] * schedule.td1) - 36.4) < 0.01


def test_events_do_not_depend_on_where_a_span_begins():
    schedule = Schedule(jittered(0.002, 0.1))
    whole = schedule.events(0, 400_000_000, 5_000_000)
    parts = [schedule.events(b, b + 40_000_000, 5_000_000) for b in range(0, 400_000_000, 40_000_000)]
    for column, pieces in zip(whole, zip(*parts, strict=True), strict=True):
        np.testing.assert_array_equal(column, np.concatenate(pieces))
