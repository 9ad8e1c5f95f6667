"""What all results have in common: named columns with units, a picture, a table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from html import escape
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np
import numpy.typing as npt

from rthm.optional import needed
from rthm_core.errors import InputError, suggestion

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

Array = npt.NDArray[Any]


class Column(NamedTuple):
    """Values (n,) of one quantity, and its SI unit; empty for what has none."""

    values: Array
    unit: str


class Result:
    """A result with columns of equal length, the first of which is what the others are drawn over."""

    @classmethod
    def of(cls, found: Any, **more: Any) -> Self:
        """Make it from the result of another package, which has the same fields."""
        return cls(**{one.name: getattr(found, one.name) for one in fields(found)}, **more)

    def columns(self) -> dict[str, Column]:
        """Columns by name, ``x1.position``."""
        raise NotImplementedError

    def shown(self) -> Sequence[str]:
        """Columns that `plot` draws when none is named."""
        return list(self.columns())[1:]

    def plot(self, *names: str) -> Figure:
        """Draw columns, a panel for each unit.

        Parameters
        ----------
        *names
            Columns; the most telling ones when none is named.

        Returns
        -------
        matplotlib.figure.Figure
            ``savefig`` writes it.

        Raises
        ------
        InputError
            If there is no column of such a name.
        """
        every = self.columns()
        (over, along), *_ = every.items()
        chosen = {name: _named(every, name) for name in names or self.shown()}
        units = list(dict.fromkeys(one.unit for one in chosen.values()))
        figure = blank(len(units))
        for axis, unit in zip(figure.axes, units, strict=True):
            for name, one in chosen.items():
                if one.unit == unit:
                    axis.plot(along.values, one.values, linewidth=1.0, label=name)
            axis.set_ylabel(unit)
            axis.legend(fontsize="small")
        figure.axes[-1].set_xlabel(with_unit(over, along.unit))
        return figure

    def to_dataframe(self) -> pandas.DataFrame:
        """Return the columns as a table of pandas; units are in ``attrs["units"]``.

        Raises
        ------
        InputError
            If pandas is not installed.
        """
        every = self.columns()
        frame = needed("pandas", "a DataFrame").DataFrame({name: one.values for name, one in every.items()})
        frame.attrs["units"] = {name: one.unit for name, one in every.items()}
        return frame

    def summary(self) -> list[tuple[str, ...]]:
        """Rows of the table in a notebook, the heading first."""
        told: list[tuple[str, ...]] = [("", "unit", "first", "last", "least", "most")]
        for name, one in self.columns().items():
            known = one.values[np.isfinite(one.values)]
            if known.size:
                numbers = known[0], known[-1], known.min(), known.max()
                told.append((name, one.unit, *(f"{number:.5g}" for number in numbers)))
        return told

    def rows(self) -> list[tuple[str, ...]]:
        """Every row of the columns as text, the heading first."""
        every = self.columns()
        values = zip(*(one.values.tolist() for one in every.values()), strict=True)
        texts = (tuple(f"{v:.5g}" if isinstance(v, float) else str(v) for v in row) for row in values)
        return [tuple(with_unit(name, one.unit) for name, one in every.items()), *texts]

    def _repr_html_(self) -> str:
        head, *rows = self.summary()
        lines = [_row("th", head), *(_row("td", row) for row in rows)]
        return f"<table><caption>{type(self).__name__}</caption>{''.join(lines)}</table>"


def _named(every: dict[str, Column], name: str) -> Column:
    if name not in every:
        near = suggestion(name, list(every)) or f"they are {', '.join(every)}"
        raise InputError(f"there is no column {name!r}; {near}.")
    return every[name]


def _row(cell: str, texts: Sequence[str]) -> str:
    return f"<tr>{''.join(f'<{cell}>{escape(text)}</{cell}>' for text in texts)}</tr>"


def with_unit(name: str, unit: str) -> str:
    """Label of an axis."""
    return f"{name}, {unit}" if unit else name


def blank(panels: int) -> Figure:
    """Figure with panels under each other, which share what they are drawn over."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 1.0 + 2.0 * panels), layout="constrained")
    FigureCanvasAgg(figure)
    figure.subplots(panels, 1, sharex=True, squeeze=False)
    return figure
