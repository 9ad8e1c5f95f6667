"""CSV as other tools write it: any usual separator, decimal commas, comments, a row of units."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from rthm_analysis.exchange.columns import Column, Columns, named
from rthm_core.errors import InputError, shown

MISSING = ("", "na", "n/a", "null", "none", "-", "nan")
COMMENTS = ("#", "%", "//")
MOST_TITLES = 50
"""Lines above a table that are looked at."""


def read_csv(path: Path) -> Columns:
    """Read a text table.

    Title lines above the table are skipped: rows of other lengths than what follows, without numbers alone.
    The first row is taken as names when it is not all numbers (else the columns are called 1, 2, ...), the
    second as units when nothing in it is a number. Empty cells are missing values.

    Raises
    ------
    InputError
        The rows have different lengths, a cell is not a number, or there is nothing in the file.
    """
    rows, decimal = _rows(path)
    if not rows:
        raise InputError(f"{path} has no rows; give a table with one row per sample.")
    rows = rows[_titles(rows, decimal) :]
    headings, first = _headings(rows, decimal)
    names, units = named(headings)
    body = rows[first:]
    if not body:
        raise InputError(f"{path} has names of columns but no numbers; give a table with one row per sample.")
    for number, cells in body:
        if len(cells) != len(names):
            raise InputError(
                f"{path}, line {number}, has {len(cells)} values, but must have {len(names)} as its first "
                f"row has; correct the line."
            )
    cells_of = zip(*(cells for _, cells in body), strict=True)
    lines = [number for number, _ in body]
    values = {
        name: _numbers(path, name, units.get(name, ""), cells, lines, decimal)
        for name, cells in zip(names, cells_of, strict=True)
    }
    return Columns(str(path), values, units)


def write_csv(path: Path, columns: Columns) -> None:
    """Write columns so that reading them gives the same numbers to the last bit."""
    texts = [[_text(value) for value in column.tolist()] for column in columns.values.values()]
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow([columns.heading(name) for name in columns.values])
        writer.writerows(zip(*texts, strict=True))


def _text(value: float) -> str:
    return "" if value != value else repr(value)


def _rows(path: Path) -> tuple[list[tuple[int, list[str]]], str]:
    """Line number and cells of every row, and the sign between whole and fractional part."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        text = path.read_text(encoding="latin-1")
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith(COMMENTS)
    ]
    if not lines:
        return [], "."
    separator = next((sign for sign in (";", "\t", ",") if sign in lines[-1][1]), None)
    decimal = "," if separator in (";", "\t") and "," in lines[-1][1] and "." not in lines[-1][1] else "."
    return list(_cells(lines, separator)), decimal


def _cells(lines: list[tuple[int, str]], separator: str | None) -> Iterator[tuple[int, list[str]]]:
    if separator is None:
        yield from ((number, line.split()) for number, line in lines)
        return
    parsed = csv.reader((line for _, line in lines), delimiter=separator, skipinitialspace=True)
    for (number, _), cells in zip(lines, parsed, strict=False):
        yield number, [cell.strip() for cell in cells]


def _titles(rows: list[tuple[int, list[str]]], decimal: str) -> int:
    """Number of rows above a table that are no part of it."""
    width = len(rows[-1][1])
    for k, (_, cells) in enumerate(rows[:MOST_TITLES]):
        if len(cells) == width:
            return k
        if all(_is_value(cell, decimal) for cell in cells):
            return 0
    return 0


def _headings(rows: list[tuple[int, list[str]]], decimal: str) -> tuple[list[str], int]:
    """Heading of every column, units included, and the number of rows they take."""
    top = rows[0][1]
    if all(_is_value(cell, decimal) for cell in top):
        return [str(k + 1) for k in range(len(top))], 0
    below = rows[1][1] if len(rows) > 1 else []
    if len(below) == len(top) and any(below) and not any(_is_value(c, decimal) for c in below if c):
        units = [cell.strip("[]() ") for cell in below]
        return [f"{name} [{unit}]" if unit else name for name, unit in zip(top, units, strict=True)], 2
    return top, 1


def _is_value(cell: str, decimal: str) -> bool:
    try:
        float(cell.replace(decimal, "."))
    except ValueError:
        return cell.lower() in MISSING
    return True


def _numbers(
    path: Path, name: str, unit: str, cells: tuple[str, ...], lines: list[int], decimal: str
) -> Column:
    if unit == "ns":
        try:
            return np.array([int(cell) for cell in cells], dtype=np.int64)
        except (ValueError, OverflowError):
            pass
    try:
        return np.array([_number(cell, decimal) for cell in cells])
    except ValueError:
        row = next(k for k, cell in enumerate(cells) if not _is_value(cell, decimal))
        raise InputError(
            f"{path}, line {lines[row]}, column {name}: {shown(cells[row])} is not a number; correct it, or "
            f"leave the cell empty when the value is not known."
        ) from None


def _number(cell: str, decimal: str) -> float:
    try:
        return float(cell.replace(decimal, ".") if decimal != "." else cell)
    except ValueError:
        if cell.lower() in MISSING:
            return float("nan")
        raise
