from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rthm_core.clock import Rank
from rthm_core.link import Inbox
from rthm_core.ros.agenda import NEVER, Agenda, Position
from rthm_core.ros.grants import SOURCES, Done, Grant

COUNTS = st.tuples(*[st.integers(0, 2**40)] * len(SOURCES))
POSITIONS = st.builds(Position, st.integers(0, NEVER), st.integers(0, 9))


def done(agenda: Agenda) -> None:
    while agenda.next().at < NEVER:
        agenda.run(agenda.next().at)


def test_events_come_in_the_order_of_their_instants_then_of_their_ranks() -> None:
    agenda, seen = Agenda(until=12), []
    agenda.every("control", 4, Rank.CONTROL, lambda at, now: seen.append((at, "control")))
    agenda.every("sample", 3, Rank.SAMPLE, lambda at, now: seen.append((at, "sample")))
    done(agenda)
    assert seen == [
        (0, "sample"), (0, "control"), (3, "sample"), (4, "control"), (6, "sample"),
        (8, "control"), (9, "sample"), (12, "sample"), (12, "control"),
    ]  # fmt: skip


def test_a_delay_that_is_over_comes_before_the_sample_of_its_instant() -> None:
    agenda, inbox, seen = Agenda(until=6), Inbox(), []
    agenda.every("sample", 3, Rank.SAMPLE, lambda at, now: seen.append(at))
    agenda.when_due(inbox, lambda at, now: seen.append(inbox.take(at)[1]))
    inbox.push(1, 3, "command")
    done(agenda)
    assert seen == [0, "command", 3, 6]


def test_a_sample_without_delay_comes_after_the_rank_at_which_it_is_sent() -> None:
    agenda, inbox, seen = Agenda(until=3), Inbox(), []
    agenda.every("sample", 3, Rank.SAMPLE, lambda at, now: seen.append(at))
    agenda.when_due(inbox, lambda at, now: seen.append(inbox.take(at)[1]), lambda stamp: Rank.CONTROL)
    inbox.push(3, 3, "command")
    done(agenda)
    assert seen == [0, 3, "command"]


def test_nothing_is_done_after_the_end() -> None:
    agenda, inbox = Agenda(until=10), Inbox()
    ticks = agenda.every("sample", 4, Rank.SAMPLE, lambda at, now: None)
    agenda.when_due(inbox, lambda at, now: pytest.fail("done after the end"))
    inbox.push(1, 11, "late")
    done(agenda)
    assert ticks.done == 3


def test_an_action_is_told_when_it_is_really_done_and_never_earlier_than_it_is_due() -> None:
    agenda, seen = Agenda(), []
    agenda.every("sample", 5, Rank.SAMPLE, lambda at, now: seen.append((at, now)))
    agenda.run(2)
    agenda.run(3)
    assert seen == [(0, 2), (5, 5)]


def test_a_tick_that_ends_after_the_next_one_was_due_is_missed() -> None:
    clock = Agenda().every("sample", 10, Rank.SAMPLE, lambda at, now: None)
    for began, ended in ((0, 9), (12, 20), (21, 31)):
        at = 10 * (began // 10)
        clock.judge(at, began, ended)
    assert clock.missed == 1
    assert clock.lateness == 2


@given(st.integers(0, 2**40), POSITIONS, COUNTS)
def test_a_grant_is_what_was_packed(round_: int, bound: Position, messages: tuple[int, ...]) -> None:
    grant = Grant(round_, bound, messages)
    assert Grant.read(grant.message()) == grant


@given(st.integers(0, 3), st.integers(0, 2**40), POSITIONS, COUNTS)
def test_an_answer_is_what_was_packed(
    part: int, round_: int, upcoming: Position, messages: tuple[int, ...]
) -> None:
    done = Done(part, round_, upcoming, messages)
    assert Done.read(done.message()) == done


@given(st.binary(max_size=200))
def test_what_is_no_grant_is_refused(noise: bytes) -> None:
    with pytest.raises(ValueError, match="is "):
        Grant.read(noise)


def test_other_programs_can_read_a_grant() -> None:
    from rclpy.serialization import deserialize_message, serialize_message
    from std_msgs.msg import Int64MultiArray

    grant = Grant(7, Position(12_000_000, 2), (10, 2, 2, 3))
    message = deserialize_message(grant.message(), Int64MultiArray)
    assert list(message.data) == [7, 12_000_000, 2, 10, 2, 2, 3]
    assert Grant.read(serialize_message(message)) == grant


def test_a_clock_that_skips_does_only_the_newest_tick_and_counts_the_others_as_missed() -> None:
    agenda, ticks, samples = Agenda(until=100), [], []
    control = agenda.every("control", 4, Rank.CONTROL, lambda at, now: ticks.append(at), skips=True)
    sample = agenda.every("sample", 3, Rank.SAMPLE, lambda at, now: samples.append(at))
    done_until(agenda, 4)
    agenda.skip(15)
    done_until(agenda, 15)
    assert ticks == [0, 4, 12]
    assert samples == [0, 3, 6, 9, 12, 15]
    assert (control.missed, sample.missed) == (1, 0)
    agenda.skip(1000)
    assert control.position().at == 100


def done_until(agenda: Agenda, at: int) -> None:
    while agenda.next().at <= at:
        agenda.run(at)
