"""The folder of a sweep: its plan, the finished batches, and the table.

A batch is written under another name and then renamed, so that what is there is whole. A sweep that was
interrupted goes on with the loops that no batch has.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.sweep.batch import Batch
from rthm_core.compiled import Floats, Integers
from rthm_core.errors import InputError

if TYPE_CHECKING:
    import pyarrow

TABLE, PLAN = "sweep.parquet", "plan.json"


class Folder:
    """Results of one sweep.

    Raises
    ------
    InputError
        When pyarrow is not installed, or the folder has another sweep in it.
    """

    def __init__(self, path: Path, plan: dict[str, Any]) -> None:
        _parquet()
        self.path, self.batches = path, path / "batches"
        self.batches.mkdir(parents=True, exist_ok=True)
        text = json.dumps(plan, indent=1, sort_keys=True)
        place = path / PLAN
        if not place.exists():
            _write(place, lambda name: name.write_text(text, encoding="utf-8"))
        elif place.read_text(encoding="utf-8") != text:
            raise InputError(
                f"{path} has the results of another sweep; give the same spec, values and duration to go on "
                f"with it, or another folder."
            )

    def finished(self, count: int) -> Integers:
        """Which of `count` loops are done."""
        done = np.zeros(count, dtype=bool)
        for name in self._names():
            done[np.asarray(_parquet().read_table(name, columns=["loop"])["loop"])] = True
        return np.flatnonzero(done)

    def add(self, batch: Batch, keys: tuple[str, ...]) -> None:
        """Keep a finished batch; nan is a missing value in the table."""
        import pyarrow

        columns = {"loop": batch.index} | {key: batch.values[:, k] for k, key in enumerate(keys)}
        found = {name: pyarrow.array(values, from_pandas=True) for name, values in batch.found.items()}
        table = pyarrow.table(columns | found)
        place = self.batches / f"{int(batch.index[0]):08d}.parquet"
        _write(place, lambda name: _parquet().write_table(table, name))

    def table(self) -> pyarrow.Table:
        """Join all batches in the order of the loops, and write them as one table."""
        import pyarrow

        parts = [_parquet().read_table(name) for name in self._names()]
        table = pyarrow.concat_tables(parts, promote_options="permissive").sort_by("loop")
        _write(self.path / TABLE, lambda name: _parquet().write_table(table, name))
        return table

    def _names(self) -> list[Path]:
        return sorted(self.batches.glob("*.parquet"))


def column(table: pyarrow.Table, name: str) -> Floats:
    """Column of a table as numbers; what is missing is nan."""
    return np.asarray(table[name].cast("float64").to_numpy(zero_copy_only=False), dtype=float)


def _parquet() -> Any:
    try:
        import pyarrow.parquet
    except ImportError:
        raise InputError(
            "tables need the package pyarrow, which is not installed; install the dependency group tables."
        ) from None
    return pyarrow.parquet


def _write(place: Path, write: Any) -> None:
    half = place.with_name(f".{place.name}.{os.getpid()}")
    try:
        write(half)
        half.replace(place)
    finally:
        half.unlink(missing_ok=True)
