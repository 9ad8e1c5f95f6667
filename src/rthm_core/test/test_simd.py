"""Values of several numbers in compiled code."""

from __future__ import annotations

import numpy as np
import pytest
from numba.core.errors import TypingError

from rthm_core.compiled import compiled_in_place
from rthm_core.simd import (
    WIDTH,
    columns,
    element,
    everywhere,
    numbers,
    put_element,
    put_first,
    put_numbers,
    several,
    simd_copy,
    simd_empty,
    will_write,
)


@compiled_in_place
def combined(a, b, c, out):
    for row in range(a.shape[0]):
        total = everywhere(1.0)
        for i in range(a.shape[1]):
            total += numbers(a, (row, i)) * numbers(b, (row, i)) / c - 2.0
        put_numbers(out, (row, 1), total)


@compiled_in_place
def doubled(a, out):
    put_numbers(out, (0,), 2.0 * numbers(a, (0,)))


@compiled_in_place
def cleared(like, out):
    for i, zeros in enumerate(several(like)):
        put_numbers(out, (i,), zeros)


@compiled_in_place
def first_ones(values, count, out):
    put_first(out, (1, 2), numbers(values, (0,)), count)


@compiled_in_place
def turned(block, out):
    for i, column in enumerate(columns(block, (1,))):
        put_numbers(out, (i,), column)


@compiled_in_place
def moved(numbered, values, out):
    for i in range(numbered.shape[0]):
        put_element(out, (0, element(numbered, (i,))), element(values, (i, 1)))


@compiled_in_place
def announced(out, place):
    will_write(out, place)


def test_what_is_said_to_be_written_is_as_it_was_and_may_be_beyond_the_end():
    out = np.arange(float(WIDTH))
    for place in (0, WIDTH - 1, 1 << 40):
        announced(out, place)
    assert np.array_equal(out, np.arange(float(WIDTH)))


def test_arithmetic_is_done_on_each_number_by_itself():
    chance = np.random.default_rng(1)
    a, b = chance.normal(size=(2, 3, 4, WIDTH))
    out = np.full((3, 2, WIDTH), 7.0)
    combined(a, b, 3.0, out)
    assert np.abs(out[:, 1] - (1.0 + (a * b / 3.0 - 2.0).sum(axis=1))).max() < 1e-14
    assert np.all(out[:, 0] == 7.0)


@pytest.mark.parametrize("count", [-1, 0, 3, WIDTH, WIDTH + 5])
def test_only_the_first_numbers_are_written(count):
    values, out = np.arange(1.0, WIDTH + 1).reshape(1, WIDTH), np.zeros((3, WIDTH + 2))
    first_ones(values, count, out)
    expected = np.zeros_like(out)
    expected[1, 2:] = np.where(np.arange(WIDTH) < count, values[0], 0.0)
    assert np.array_equal(out, expected)


def test_rows_of_a_block_become_columns():
    block, out = np.random.default_rng(2).normal(size=(2, WIDTH, WIDTH)), np.empty((WIDTH, WIDTH))
    turned(block, out)
    assert np.array_equal(out, block[1].T)


def test_single_elements_are_read_and_written():
    values, out = np.arange(6.0).reshape(3, 2), np.zeros((1, 4))
    moved(np.array([2, 0, 3]), values, out)
    assert np.array_equal(out, [[3.0, 0.0, 1.0, 5.0]])


def test_as_many_zeros_as_asked_for():
    out = np.ones((3, WIDTH))
    cleared((1.0, 2.0), out)
    assert np.array_equal(out, np.concatenate([np.zeros((2, WIDTH)), np.ones((1, WIDTH))]))


@pytest.mark.parametrize(
    "out",
    [np.zeros((WIDTH, 2)).T, np.zeros((2, WIDTH), dtype=np.float32), np.zeros((1, 2, WIDTH))],
    ids=["strided", "single precision", "another axis"],
)
def test_numbers_that_do_not_lie_side_by_side_are_refused(out):
    with pytest.raises(TypingError, match="side by side"):
        doubled(np.zeros((2, WIDTH)), out)


def test_arrays_for_simd_values_begin_at_a_line_of_memory():
    kept = [np.empty(odd) for odd in range(1, 40, 2)]  # so that what follows begins anywhere
    values = np.arange(3.0 * 5 * WIDTH).reshape(5, 3, WIDTH).swapaxes(0, 1)
    for array in (simd_empty(7, WIDTH), simd_empty(0, WIDTH), simd_copy(values), *map(simd_copy, kept)):
        assert array.flags.c_contiguous
        assert array.ctypes.data % (8 * WIDTH) == 0 or array.size == 0
    assert np.array_equal(simd_copy(values), values)
