"""MAT files: versions 5 and 7 by scipy, 7.3 (which is HDF5) by h5py where that is installed."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from rthm_analysis.exchange.columns import Column, Columns, split_heading
from rthm_core.errors import InputError

HEADINGS = "headings"
"""Variable of our own files: for every variable its full name and unit."""

LONGEST_NAME = 63
"""Characters that MATLAB allows in the name of a variable."""


def read_mat(path: Path) -> Columns:
    """Read all vectors and the columns of all matrices; fields of a struct are called ``struct.field``.

    Raises
    ------
    InputError
        It is not a MAT file, or one of version 7.3 and h5py is not installed.
    """
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    try:
        content = loadmat(path, simplify_cells=True)
    except NotImplementedError:
        content = _hdf5(path)
    except (MatReadError, ValueError, TypeError, EOFError, IndexError, KeyError) as reason:
        raise InputError(f"{path} is not a MAT file that can be read ({reason}); save it again.") from None
    headings = _headings(content.pop(HEADINGS, None))
    values: dict[str, Column] = {}
    units: dict[str, str] = {}
    for variable, column in _columns(content):
        name, unit = split_heading(headings[variable]) if variable in headings else (variable, "")
        values[name] = column
        if unit:
            units[name] = unit
    return Columns(str(path), values, units)


def write_mat(path: Path, columns: Columns) -> None:
    """Write every column as a variable; the cell array `headings` has the full names with their units."""
    from scipy.io import savemat

    variables: dict[str, str] = {}
    for name in columns.values:
        plain = re.sub(r"\W", "_", name)[: LONGEST_NAME - 4]
        plain = plain if plain[:1].isalpha() else f"x{plain}"
        while plain in variables:
            plain += "_"
        variables[plain] = name
    headings = np.array([[plain, columns.heading(name)] for plain, name in variables.items()], dtype=object)
    content: dict[str, Any] = {plain: columns.values[name][:, None] for plain, name in variables.items()}
    savemat(path, {HEADINGS: headings} | content, do_compression=True)


def _headings(told: Any) -> dict[str, str]:
    """Full name of every variable, of a file that we wrote."""
    rows = np.atleast_2d(np.asarray(told, dtype=object)) if told is not None else np.empty((0, 2))
    return {str(row[0]): str(row[1]) for row in rows if len(row) == 2}


def _columns(content: Mapping[str, Any], within: str = "") -> Iterator[tuple[str, Column]]:
    for name, value in content.items():
        if name.startswith("__"):
            continue
        if isinstance(value, Mapping):
            yield from _columns(value, f"{within}{name}.")
        elif isinstance(value, np.ndarray) and value.dtype.kind in "fiub":
            yield from _of_array(f"{within}{name}", value)


def _of_array(name: str, array: Any) -> Iterator[tuple[str, Column]]:
    array = np.squeeze(array)
    if array.ndim == 2 and array.shape[0] < array.shape[1]:
        array = array.T
    if array.dtype != np.int64:
        array = array.astype(float)
    if array.ndim == 1:
        yield name, array
    elif array.ndim == 2:
        yield from ((f"{name}[{k}]", array[:, k]) for k in range(array.shape[1]))


def _hdf5(path: Path) -> dict[str, Any]:
    try:
        import h5py
    except ImportError:
        raise InputError(
            f"{path} is a MAT file of version 7.3, which needs the package h5py; install it, or save the "
            f"file with -v7."
        ) from None

    def content(group: Any) -> dict[str, Any]:
        return {
            name: content(item) if isinstance(item, h5py.Group) else np.asarray(item)
            for name, item in group.items()
            if not name.startswith("#")
        }

    with h5py.File(path) as file:
        return content(file)
