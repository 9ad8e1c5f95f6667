"""States of eight loops at once, with the held inputs behind them, in the compiled kernel of ensembles.

A small state is a tuple of SIMD values, which stays in registers from event to event; a larger one is a flat
array (8 n,), one element after the other. Both take the same kernel.
"""

from __future__ import annotations

from typing import Any

from numba.core import types
from numba.cpython.unsafe.tuple import tuple_setitem
from numba.extending import overload

from rthm_core.compiled import written_out
from rthm_core.simd import WIDTH, everywhere, numbers_from, put_numbers_from, several


def state_of(values: Any, like: Any) -> Any:
    """State with such values (8 n,): a tuple where `like` is one, else the array itself."""


@overload(state_of)  # type: ignore[untyped-decorator]
def _state_of(values: Any, like: Any) -> Any:
    if isinstance(like, types.Array):

        def as_it_is(values: Any, like: Any) -> Any:
            return values

        return as_it_is

    def in_registers(values: Any, like: Any) -> Any:
        state = several(like)
        for i in range(len(like)):
            state = tuple_setitem(state, i, numbers_from(values, i * WIDTH))
        return state

    return in_registers


def taken(state: Any, i: Any) -> Any:
    """Element of a state."""


@overload(taken)  # type: ignore[untyped-decorator]
def _taken(state: Any, i: Any) -> Any:
    if isinstance(state, types.Array):

        def of_array(state: Any, i: Any) -> Any:
            return numbers_from(state, i * WIDTH)

        return of_array

    def of_tuple(state: Any, i: Any) -> Any:
        return state[i]

    return of_tuple


def put(state: Any, i: Any, value: Any) -> Any:
    """`state` with an element replaced; an array is changed in place."""


@overload(put)  # type: ignore[untyped-decorator]
def _put(state: Any, i: Any, value: Any) -> Any:
    if isinstance(state, types.Array):

        def in_place(state: Any, i: Any, value: Any) -> Any:
            put_numbers_from(state, i * WIDTH, value)
            return state

        return in_place

    def of_tuple(state: Any, i: Any, value: Any) -> Any:
        return tuple_setitem(state, i, value)

    return of_tuple


def laid(state: Any, memory: Any, place: Any) -> Any:
    """Array in which a state lies, and its place there: the memory given, or its own."""


@overload(laid)  # type: ignore[untyped-decorator]
def _laid(state: Any, memory: Any, place: Any) -> Any:
    if isinstance(state, types.Array):

        def as_it_is(state: Any, memory: Any, place: Any) -> Any:
            return state, 0

        return as_it_is

    def stored(state: Any, memory: Any, place: Any) -> Any:
        for i in range(len(state)):
            put_numbers_from(memory, place + i * WIDTH, state[i])
        return memory, place

    return stored


@written_out
def seen(memory, step, i, state, made, of):  # type: ignore[no-untyped-def]
    """Element `i` of what the step in the memory at a place makes of a state.

    The tuples or arrays `made` and `of` are as long as all that it makes and as the state.
    """
    total = everywhere(0.0)
    for j in range(len(of)):
        total += numbers_from(memory, step + (j * len(made) + i) * WIDTH) * taken(state, j)
    return total


def moved(memory: Any, step: Any, state: Any, made: Any, of: Any, scratch: Any) -> Any:
    """State after a step; an array is changed in place, by way of `scratch` in the memory."""


@overload(moved)  # type: ignore[untyped-decorator]
def _moved(memory: Any, step: Any, state: Any, made: Any, of: Any, scratch: Any) -> Any:
    if isinstance(state, types.Array):

        def by_memory(memory: Any, step: Any, state: Any, made: Any, of: Any, scratch: Any) -> Any:
            for i in range(len(made)):
                put_numbers_from(memory, scratch + i * WIDTH, seen(memory, step, i, state, made, of))
            for i in range(len(made)):
                put_numbers_from(state, i * WIDTH, numbers_from(memory, scratch + i * WIDTH))
            return state

        return by_memory

    def in_registers(memory: Any, step: Any, state: Any, made: Any, of: Any, scratch: Any) -> Any:
        result = state
        for i in range(len(made)):
            result = tuple_setitem(result, i, seen(memory, step, i, state, made, of))
        return result

    return in_registers
