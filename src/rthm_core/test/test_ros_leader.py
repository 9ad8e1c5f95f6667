"""Locks of nodes in a test."""

from __future__ import annotations

from rthm_core.ros import leader


def test_only_the_word_opens_a_lock_during_a_test() -> None:
    word = leader.new_word()
    lock = leader.lock_of(word)
    assert leader.is_closed(lock)
    assert leader.may_set(True, lock, word)
    assert not leader.is_closed(word)
    for foreign in ("", lock, leader.lock_of("another"), leader.new_word()):
        assert not leader.may_set(True, lock, foreign)


def test_outside_of_a_test_anybody_may_become_the_leader() -> None:
    assert leader.may_set(False, leader.lock_of("one"), leader.lock_of("other"))
    assert leader.may_set(True, "", leader.lock_of("other"))


def test_two_words_are_never_the_same() -> None:
    assert len({leader.new_word() for _ in range(100)}) == 100
