"""Some loops of a sweep, run one after the other by a worker."""

from __future__ import annotations

import time
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from rthm_analysis.sweep.points import Points
from rthm_core.compiled import Floats, Integers
from rthm_core.errors import InputError


class Order(NamedTuple):
    """What a worker needs to know: the spec as text, what is varied, and how long every loop runs (s)."""

    spec: str
    keys: tuple[str, ...]
    duration: float


class Batch(NamedTuple):
    """Loops `index` (n,) with their `values` (n, K), and what was found: columns (n,) by name.

    `seconds` is what the batch took, without what a fresh worker takes to get ready.
    """

    index: Integers  # type: ignore[assignment]
    values: Floats
    found: dict[str, list[Any]]
    seconds: float


def run_batch(order: Order, index: Integers, values: Floats) -> Batch:
    """Run some loops; one that is not allowed has nan and its sentence in the column ``refused``."""
    _ready(order, tuple(values[0]))
    begin = time.perf_counter()
    rows = [_run(order, tuple(one)) for one in values]
    seconds = time.perf_counter() - begin
    return Batch(index, values, {name: [row[name] for row in rows] for name in rows[0]}, seconds)


@cache
def _ready(order: Order, values: tuple[float, ...]) -> None:
    """Run a first loop for nothing, so that compiled code is loaded before time is taken."""
    if _ready.cache_info().currsize == 0:
        _run(order, values)


def _run(order: Order, values: tuple[float, ...]) -> dict[str, Any]:
    from rthm_analysis.sweep.quantities import QUANTITIES, measure

    try:
        # A loop that grows without bound ends as inf or nan, and that is what the table says.
        with np.errstate(all="ignore"):
            found, refused = measure(_points(order.spec, order.keys).at(values), order.duration)
        radius = found["spectral_radius"]
        return {"stable": None if np.isnan(radius) else radius < 1.0, **found, "refused": refused}
    except InputError as error:
        return {"stable": None, **dict.fromkeys(QUANTITIES, np.nan), "refused": str(error)}


@cache
def _points(text: str, keys: tuple[str, ...]) -> Points:
    from rthm_core.spec import spec_with_own_effects
    from rthm_core.spec.yaml_text import parameters_in

    return Points(spec_with_own_effects(parameters_in(text)), keys)
