"""A second publisher of a topic is noticed, and a single one never is."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from rthm_core.owner import UNNUMBERED, Ownership, second_owner

SPACING = 1_200_000


def test_two_publishers_of_a_topic_are_told_with_their_names() -> None:
    one = {"plant/state": ["/rthm/plant"], "actuator/command": ["/rthm/actuator"]}
    assert second_owner(one) == ""
    assert second_owner({"plant/state": []}) == ""
    two = one | {"actuator/command": ["/rthm/teleop", "/rthm/actuator"]}
    assert second_owner(two) == (
        "actuator/command has 2 publishers, /rthm/actuator and /rthm/teleop, but must have one"
    )


@given(st.lists(st.integers(0, 1), min_size=2, max_size=60), st.integers(0, 5000), st.integers(0, 5000))
def test_samples_of_two_publishers_are_told_apart_whatever_their_numbers_and_order(
    order: list[int], first: int, second: int
) -> None:
    """Two streams that each count by one cannot look like one for longer than a few samples."""
    counts, ownership, refused = [first, second], Ownership(SPACING), 0
    for tick, who in enumerate([*order, 0, 1, 0, 1] * 20):
        counts[who] += 1
        refused += not ownership.accept(counts[who], tick * SPACING)
    assert refused
    assert ownership.words.endswith("of another publisher")


@given(st.lists(st.integers(1, 400), max_size=200), st.integers(0, 2**40))
def test_a_publisher_that_loses_samples_stays_the_owner(steps: list[int], number: int) -> None:
    ownership, stamp = Ownership(SPACING), 0
    for step in steps:
        number, stamp = number + step, stamp + step * SPACING
        assert ownership.accept(number, stamp)
    assert not ownership.words


def test_samples_sent_in_a_burst_after_a_stall_are_of_the_same_publisher() -> None:
    ownership = Ownership(SPACING)
    assert all(ownership.accept(number, number * SPACING) for number in range(1, 1000))
    assert ownership.accept(1000, 999 * SPACING)  # an extra command of the same instant


def test_a_forged_sample_far_ahead_is_not_used_and_the_owner_goes_on() -> None:
    ownership = Ownership(SPACING)
    assert ownership.accept(10, 10 * SPACING)
    assert not ownership.accept(5000, 11 * SPACING)
    assert not ownership.accept(3, 12 * SPACING)
    assert ownership.accept(11, 11 * SPACING)
    assert ownership.words == "sample 5000 came after 10, of another publisher"


def test_without_numbers_nothing_is_known() -> None:
    ownership = Ownership(SPACING)
    assert all(ownership.accept(UNNUMBERED, stamp) for stamp in (3, 2, 1))
