"""Parquet files, by pyarrow where that is installed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from rthm_analysis.exchange.columns import Column, Columns, named
from rthm_core.errors import InputError


def read_parquet(path: Path) -> Columns:
    """Read all columns of numbers and instants; InputError when that cannot be done."""
    arrow, parquet = _pyarrow()
    try:
        table = parquet.read_table(path)
    except (arrow.ArrowInvalid, arrow.ArrowNotImplementedError) as reason:
        raise InputError(
            f"{path} is not a Parquet file that can be read ({reason}); save it again."
        ) from None
    names, units = named(table.column_names)
    values: dict[str, Column] = {}
    for name, column in zip(names, table.columns, strict=True):
        kind = column.type
        if arrow.types.is_timestamp(kind):
            values[name], units[name] = _integers(column.cast(arrow.timestamp("ns"))), "ns"
        elif units.get(name) == "ns" and arrow.types.is_integer(kind):
            values[name] = _integers(column)
        elif arrow.types.is_integer(kind) or arrow.types.is_floating(kind) or arrow.types.is_boolean(kind):
            values[name] = np.asarray(column.cast(arrow.float64()).to_numpy(), dtype=float)
    return Columns(str(path), values, units)


def write_parquet(path: Path, columns: Columns) -> None:
    """Write columns; InputError when pyarrow is not installed."""
    arrow, parquet = _pyarrow()
    parquet.write_table(
        arrow.table({columns.heading(name): values for name, values in columns.values.items()}), path
    )


def _integers(column: Any) -> Column:
    return np.asarray(column.cast("int64").to_numpy(), dtype=np.int64)


def _pyarrow() -> tuple[Any, Any]:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise InputError(
            "Parquet needs the package pyarrow, which is not installed; install the dependency group tables."
        ) from None
    return pyarrow, pyarrow.parquet
