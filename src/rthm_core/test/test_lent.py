"""Records that compiled functions hand on by their address."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from rthm_core.compiled import compiled_in_place, inlined, whole
from rthm_core.lent import given, lent


class Inner(NamedTuple):
    factors: Any
    offset: float


class Record(NamedTuple):
    numbers: Any
    doubles: bool
    inner: Inner


@inlined
def scaled(inner, x):  # type: ignore[no-untyped-def]
    return inner.factors[0] * x + inner.offset


@whole
def change(record):  # type: ignore[no-untyped-def]
    own = lent(given(record))
    for i in range(own.numbers.size):
        own.numbers[i] = scaled(own.inner, own.numbers[i])
        if own.doubles:
            own.numbers[i] *= 2.0


@compiled_in_place
def change_lent(record: Record) -> None:
    change(lent(record))


@compiled_in_place
def change_itself(record: Record) -> None:
    change(record)


def record(doubles: bool) -> Record:
    return Record(np.arange(4.0), doubles, Inner(np.array([3.0]), 0.5))


def test_what_is_lent_has_the_fields_of_the_record_and_its_arrays_are_changed_in_place() -> None:
    for doubles in (False, True):
        one = record(doubles)
        change_lent(one)
        np.testing.assert_array_equal(one.numbers, (3.0 * np.arange(4.0) + 0.5) * (2.0 if doubles else 1.0))


def test_a_function_takes_a_record_itself_as_well() -> None:
    one, other = record(True), record(True)
    change_lent(one)
    change_itself(other)
    np.testing.assert_array_equal(one.numbers, other.numbers)


def test_in_python_a_record_is_itself() -> None:
    one = record(False)
    assert given(lent(one)) is one
