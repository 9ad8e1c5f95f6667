"""What a command adds that arrives between two instants of the clocks, from its tables, compiled."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numba.core import types
from numba.extending import overload

from rthm_core.addressed import part
from rthm_core.compiled import written_out
from rthm_core.engine.linear.arrivals import TERMS_KEPT
from rthm_core.engine.linear.vectors import put
from rthm_core.simd import WIDTH, everywhere, numbers, put_numbers


def inlined_state(function: Callable[..., Any]) -> Any:
    """As `written_out`, for a function that gives a state back, be it a tuple or an array that it changes."""
    return part(function, nrt=True, written_out=True)


@written_out
def piece(responses, length):  # type: ignore[no-untyped-def]
    """Number of the piece in which a length (ns) lies, and its distance from the middle in half pieces."""
    k = np.uint64(min(int(length * responses.scale), responses.centres.size - 1))
    return k, (length - responses.centres[k]) * 2.0 * responses.scale


@inlined_state
def responded(terms, k, x, change, plant):  # type: ignore[no-untyped-def]
    """State of the plant with its response to a change of its inputs."""
    for i in range(len(plant)):
        total = plant[i]
        for j in range(len(change)):
            response = terms[k, TERMS_KEPT - 1, j, i]
            for power in range(TERMS_KEPT - 2, -1, -1):
                response = response * x + terms[k, power, j, i]
            total += response * change[j]
        plant = put(plant, i, total)
    return plant


def joint(z: Any, plant: Any, command: Any, numerical: Any, held: Any) -> Any:
    """The joint state of both sides: a tuple where all its parts are tuples, else `z`, written."""


@overload(joint)  # type: ignore[untyped-decorator]
def _joint(z: Any, plant: Any, command: Any, numerical: Any, held: Any) -> Any:
    if not any(isinstance(part, types.Array) for part in (plant, command, numerical, held)):

        def of_tuples(z: Any, plant: Any, command: Any, numerical: Any, held: Any) -> Any:
            return plant + command + numerical + held

        return of_tuples

    def in_place(z: Any, plant: Any, command: Any, numerical: Any, held: Any) -> Any:
        at = 0
        for i in range(len(plant)):
            z[i] = plant[i]
        at = len(plant)
        for i in range(len(command)):
            z[at + i] = command[i]
        at += len(command)
        for i in range(len(numerical)):
            z[at + i] = numerical[i]
        at += len(numerical)
        for i in range(len(held)):
            z[at + i] = held[i]
        return z

    return in_place


@written_out
def _pass_on(works, responses, length, z):  # type: ignore[no-untyped-def]
    """Write the joint state a length (ns) later that may be any."""
    k, x = piece(responses, length)
    steps = works.steps
    for group in range(steps.shape[3]):
        total = everywhere(0.0)
        for power in range(steps.shape[1] - 1, -1, -1):
            part = everywhere(0.0)
            for j in range(len(z)):
                part += numbers(steps, (k, power, j, group)) * z[j]
            total = total * x + part
        put_numbers(works.later, (group,), total)


@inlined_state
def passed(works, responses, length, z):  # type: ignore[no-untyped-def]
    """The joint state a length (ns) later that may be any."""
    _pass_on(works, responses, length, z)
    for i in range(len(z)):
        z = put(z, i, works.later[i // WIDTH, i % WIDTH])
    return z


@inlined_state
def changed(z, first, share, change):  # type: ignore[no-untyped-def]
    """The joint state with a share of a change of the inputs, which begin at `first`."""
    for j in range(len(change)):
        z = put(z, first + j, z[first + j] + share * change[j])
    return z


@written_out
def added_work(works, k, x, change, z):  # type: ignore[no-untyped-def]
    """Work (8,), a SIMD value, that a change of the inputs makes until the next instant of the clocks; `z` is
    the joint state with the mean of what they were and are.
    """
    products, added, inputs = works.products, works.added, len(change)
    for i in range(len(z)):
        for j in range(inputs):
            products[i * inputs + j] = z[i] * change[j]
    total = everywhere(0.0)
    for power in range(added.shape[1] - 1, -1, -1):
        part = everywhere(0.0)
        for pair in range(products.size):
            part += numbers(added, (k, power, pair)) * products[pair]
        total = total * x + part
    return total
