"""Data of the package ``nonlinear_benchmarks``: what its functions return, as columns u and y."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from contextlib import redirect_stdout
from typing import Any

import numpy as np

from rthm_analysis.exchange.columns import Column, Columns
from rthm_core.errors import InputError

PARTS = {2: ("train", "test")}
"""What the parts of a benchmark are called that is split into so many."""


def benchmark(name: str) -> object:
    """Fetch a benchmark by its name, such as ``Silverbox``.

    Raises
    ------
    InputError
        The package is not installed, does not know the name, or cannot fetch the data.
    """
    try:
        import nonlinear_benchmarks  # type: ignore[import-not-found,unused-ignore]
    except ImportError:
        raise InputError(
            f"{name} is not a file, and benchmarks need the package nonlinear_benchmarks; give a file "
            f"that is there, or install it."
        ) from None
    more = getattr(nonlinear_benchmarks, "not_splitted_benchmarks", None)
    function = getattr(nonlinear_benchmarks, name, None) or getattr(more, name, None)
    if not name.isidentifier() or not callable(function):
        raise InputError(f"{name} is neither a file nor a benchmark of nonlinear_benchmarks; correct it.")
    try:
        with redirect_stdout(sys.stderr):  # what it says while it downloads is no result
            return function()
    except Exception as reason:  # whatever a download or an unpacker may raise
        raise InputError(
            f"The benchmark {name} cannot be fetched ({reason}); try again, or give a file."
        ) from None


def benchmark_columns(data: object, name: str) -> list[Columns]:
    """Return one set of columns for every recording in what a benchmark's function returned.

    Parameters
    ----------
    data
        An object with ``u``, ``y`` and ``sampling_time`` (``Input_output_data``), or tuples and lists of
        them, at any depth; of two parts the first is called train, the second test.
    name : str
        What they are called, where they have no names.

    Raises
    ------
    InputError
        There is something else in it.
    """
    return [_columns(one, label) for label, one in _flat(data, name)]


def _flat(data: Any, name: str) -> Iterator[tuple[str, Any]]:
    if hasattr(data, "u") and hasattr(data, "y"):
        own = re.sub(r"\W+", "_", str(getattr(data, "name", "") or "")).strip("_")
        yield own or name, data
    elif isinstance(data, tuple | list) and data:
        labels = PARTS.get(len(data), tuple(str(k + 1) for k in range(len(data))))
        for label, part in zip(labels, data, strict=True):
            yield from _flat(part, f"{name}_{label}")
    else:
        raise InputError(
            f"{name} is {type(data).__name__}, but must have u, y and sampling_time, or be a tuple of such; "
            f"give what a function of nonlinear_benchmarks returns."
        )


def _columns(data: Any, name: str) -> Columns:
    values = {**_of("u", data.u), **_of("y", data.y)}
    time: Any = getattr(data, "sampling_time", None)
    if np.ndim(time) == 1 and np.size(time) == np.size(values.get("y", ())):
        return Columns(name, values | {"time": np.asarray(time, dtype=float)})
    period = float(time) if np.size(time) == 1 and time is not None else None
    if period is not None and not 0.0 < period < 1e6:
        raise InputError(f"{name} has the sampling time {period!r} s, but it must be above 0; correct it.")
    return Columns(name, values, period=period)


def _of(name: str, values: Any) -> dict[str, Column]:
    array = np.asarray(values, dtype=float)
    array = array[:, None] if array.ndim == 1 else array
    if array.shape[1] == 1:
        return {name: array[:, 0]}
    return {f"{name}[{k}]": array[:, k] for k in range(array.shape[1])}
