"""Which file format a name stands for."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from rthm_analysis.exchange.columns import Columns
from rthm_analysis.exchange.csv_file import read_csv, write_csv
from rthm_analysis.exchange.mat_file import read_mat, write_mat
from rthm_analysis.exchange.parquet_file import read_parquet, write_parquet
from rthm_core.errors import InputError

READERS: dict[str, Callable[[Path], Columns]] = {
    ".csv": read_csv,
    ".txt": read_csv,
    ".tsv": read_csv,
    ".dat": read_csv,
    ".mat": read_mat,
    ".parquet": read_parquet,
}
WRITERS: dict[str, Callable[[Path, Columns], None]] = {
    ".csv": write_csv,
    ".mat": write_mat,
    ".parquet": write_parquet,
}


def read_columns(path: Path) -> Columns:
    """Read a file by its ending.

    Raises
    ------
    InputError
        It is not there, of a kind that nothing here reads, or has no columns.
    """
    if not path.is_file():
        raise InputError(f"{path} is not a file; give one that ends in {', '.join(READERS)}.")
    if path.suffix.lower() not in READERS:
        raise InputError(f"{path} ends in none of {', '.join(READERS)}; convert it to one of these.")
    columns = READERS[path.suffix.lower()](path)
    if not columns.values:
        raise InputError(f"{path} has no columns of numbers; give a table with one row per sample.")
    return columns


def write_columns(path: Path, columns: Columns) -> None:
    """Write a file by its ending; InputError when there is no such format."""
    if path.suffix.lower() not in WRITERS:
        raise InputError(f"{path} must end in one of {', '.join(WRITERS)}; give another name.")
    path.parent.mkdir(parents=True, exist_ok=True)
    WRITERS[path.suffix.lower()](path, columns)
