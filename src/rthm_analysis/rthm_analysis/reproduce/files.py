"""Results as files: pictures, CSV, JSON."""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from rthm_analysis.reproduce.errata import Erratum
from rthm_analysis.reproduce.numbers import Numbers
from rthm_analysis.reproduce.tables import Table


def write_numbers(folder: Path, name: str, numbers: Numbers) -> None:
    """Write one CSV per table of a figure."""
    for table, columns in numbers.tables.items():
        rows = zip(*(np.asarray(column).tolist() for column in columns.values()), strict=True)
        _write_csv(folder / table_file(name, table), list(columns), rows)


def table_file(name: str, table: str) -> str:
    """Name of the file of a table of a figure."""
    return f"{name}_{table.replace(' ', '_')}.csv"


def write_table(folder: Path, table: Table) -> None:
    """Write a table as CSV."""
    _write_csv(folder / f"{table.name}.csv", table.head, table.rows)


def write_errata(folder: Path, errata: Sequence[Erratum]) -> None:
    """Write the errata as CSV."""
    rows = [list(one.as_dict().values()) for one in errata]
    _write_csv(folder / "errata.csv", list(errata[0].as_dict()), rows)


def write_json(path: Path, result: Mapping[str, Any]) -> None:
    """Write everything as JSON."""
    path.write_text(json.dumps(result, default=_plain, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def _plain(value: Any) -> Any:
    return value.tolist() if hasattr(value, "tolist") else str(value)


def _write_csv(path: Path, head: Sequence[str], rows: Any) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(head)
        writer.writerows([["" if one is None else one for one in row] for row in rows])
