"""CSV as other tools write it: any usual separator, decimal commas, comments, titles, a row of units."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

from rthm_analysis.exchange.cells import has_decimal_comma, is_instant, read_column
from rthm_analysis.exchange.columns import Columns, named
from rthm_analysis.exchange.headings import Row, headings_of
from rthm_core.errors import InputError

COMMENTS = ("#", "%", "//")


def read_csv(path: Path) -> Columns:
    """Read a text table.

    Lines above the names are skipped, and a row of units may lie below them; without names the columns are
    called 1, 2, ... Empty cells are missing values, and so is all of a column of words. Dates and times of
    day become instants, in ns.

    Raises
    ------
    InputError
        The rows have different lengths, a cell among numbers is none, or there is nothing in the file.
    """
    rows, decimal = _rows(path)
    if not rows:
        raise InputError(f"{path} has no rows; give a table with one row per sample.")
    headings, first = headings_of(rows, decimal)
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
    units |= {name: "ns" for name, cell in zip(names, body[0][1], strict=True) if is_instant(cell)}
    lines = [number for number, _ in body]
    columns = zip(names, zip(*(cells for _, cells in body), strict=True), strict=True)
    values = {
        name: read_column(str(path), name, units.get(name, ""), cells, lines, decimal)
        for name, cells in columns
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


def _rows(path: Path) -> tuple[list[Row], str]:
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
    rows = list(_cells(lines, separator))
    return rows, "," if separator != "," and has_decimal_comma(rows[-1][1]) else "."


def _cells(lines: list[tuple[int, str]], separator: str | None) -> Iterator[Row]:
    if separator is None:
        yield from ((number, line.split()) for number, line in lines)
        return
    parsed = csv.reader((line for _, line in lines), delimiter=separator, skipinitialspace=True)
    for (number, _), cells in zip(lines, parsed, strict=False):
        yield number, [cell.strip() for cell in cells]
