"""Ctrl-C is obeyed where it may be, and nothing is broken off elsewhere."""

from __future__ import annotations

import signal

import pytest

from rthm_bringup.interruption import held_back, interrupted_by

ASKED = [signal.SIGINT, signal.SIGTERM]


@pytest.mark.parametrize("asked", ASKED)
def test_a_program_obeys_at_once(asked: signal.Signals) -> None:
    before = signal.getsignal(asked)
    with pytest.raises(KeyboardInterrupt), interrupted_by(asked):
        signal.raise_signal(asked)
    assert signal.getsignal(asked) is before


@pytest.mark.parametrize("asked", ASKED)
def test_what_is_held_back_is_obeyed_once_when_asked(asked: signal.Signals) -> None:
    before = signal.getsignal(asked)
    with held_back() as interruption:
        interruption.obey()
        signal.raise_signal(asked)
        signal.raise_signal(asked)
        with pytest.raises(KeyboardInterrupt):
            interruption.obey()
        interruption.obey()
    assert signal.getsignal(asked) is before


def held_back_until_the_end(told: list[str], error: Exception | None = None) -> None:
    with held_back():
        signal.raise_signal(signal.SIGINT)
        told.append("what comes behind it")
        if error is not None:
            raise error


def test_what_was_not_obeyed_is_at_the_end() -> None:
    told: list[str] = []
    with pytest.raises(KeyboardInterrupt):
        held_back_until_the_end(told)
    assert told


def test_an_error_is_told_before_an_interruption() -> None:
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(ValueError, match="first"):
        held_back_until_the_end([], ValueError("first"))
    assert signal.getsignal(signal.SIGINT) is before
