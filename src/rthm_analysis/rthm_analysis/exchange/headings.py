"""Where the numbers of a text table begin, and how its columns are called."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import mode

from rthm_analysis.exchange.cells import is_known, is_value
from rthm_analysis.exchange.columns import split_heading
from rthm_analysis.exchange.units import FACTORS

Row = tuple[int, list[str]]
"""Number of a line, and its cells."""

ROWS_SEEN = 50
"""Rows at the end of a table that tell its width."""

UNITS = {unit for units in FACTORS.values() for unit in units}


def headings_of(rows: Sequence[Row], decimal: str) -> tuple[list[str], int]:
    """Heading of every column, units included, and the number of rows above the numbers.

    The row above the numbers has the names, or the units, and that above it the names.
    """
    table = [cells for _, cells in rows]
    width = mode(len(cells) for cells in table[-ROWS_SEEN:])
    first = _first_of_numbers(table, width, decimal)
    if first == 0 or len(table[first - 1]) != width:
        return [str(k + 1) for k in range(width)], first
    names, above = table[first - 1], table[first - 2] if first > 1 else []
    if len(above) == width and _are_units(names, above, decimal, alone=first == 2):
        units = [cell.strip("[]() ") for cell in names]
        names = [f"{name} [{unit}]" if unit else name for name, unit in zip(above, units, strict=True)]
    return names, first


def _first_of_numbers(table: Sequence[list[str]], width: int, decimal: str) -> int:
    """Number of rows above the first one of numbers; below the names where there is none.

    A row of numbers has them, or missing values, in the columns that have one in the last row. With words in
    a few of these it is one as well, and told to be wrong where it is read; but then the first row of its
    width has names such as 1, 2 and 3.
    """
    full = [k for k, cells in enumerate(table) if len(cells) == width]
    last = next((table[k] for k in reversed(full) if any(is_known(c, decimal) for c in table[k])), [])
    numeric = [j for j, cell in enumerate(last) if is_known(cell, decimal)]
    for k in full:
        known = sum(is_known(table[k][j], decimal) for j in numeric)
        whole = all(is_value(table[k][j], decimal) for j in numeric)
        if (whole and known) or (2 * known > len(numeric) and k != full[0]):
            return k
    return full[0] + 1


def _are_units(below: Sequence[str], names: Sequence[str], decimal: str, *, alone: bool) -> bool:
    """Whether a row has the units of the names above it; where nothing is above these, any words are."""
    if not any(below) or any(is_value(cell, decimal) for cell in below if cell):
        return False
    if any(cell and not name for cell, name in zip(below, names, strict=True)):
        return False
    named = any(unit for _, unit in map(split_heading, below))
    return not named and (alone or any(cell.strip("[]() ") in UNITS for cell in below))
