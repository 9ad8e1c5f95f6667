"""What a diagnosis found, as a result."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm.results import Column, Result, blank
from rthm_analysis import diagnosis
from rthm_analysis.diagnosis.result import Value

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MODELS = ("nominal", "retuned", "explained", "noise_floor")


class Diagnosis(Result, diagnosis.Diagnosis):
    """What a diagnosis found; its fields are those of `rthm_analysis.diagnosis.Diagnosis`.

    ``verdict`` is ``match``, ``retuned``, ``explained``, ``improved`` or ``unexplained``, ``words`` the
    answer in sentences, ``physics`` what is missing in the model, ``patched`` the text of a spec that has
    it.
    """

    def columns(self) -> dict[str, Column]:
        """A row for every number of the physics that was found."""
        rows = [
            (f"{one.block}.{one.kind}.{key}", one.place or one.block, value.value, value.std, value.unit)
            for one in self.physics
            for key, value in one.parameters.items()
            if isinstance(value, Value)
        ]
        names, places, values, stds, units = zip(*rows, strict=True) if rows else ((),) * 5
        return {
            "parameter": Column(np.array(names, dtype=str), ""),
            "place": Column(np.array(places, dtype=str), ""),
            "value": Column(np.array(values, dtype=float), ""),
            "std": Column(np.array(stds, dtype=float), ""),
            "unit": Column(np.array(units, dtype=str), ""),
        }

    def plot(self, *names: str) -> Figure:
        """Draw the error of each signal on unseen data: of the nominal, retuned and explained model, and of
        the noise alone.

        Parameters
        ----------
        *names
            Signals, as ``x1``; all when none is named.

        Returns
        -------
        matplotlib.figure.Figure
        """
        figure = blank(1)
        for fit in self.fits:
            if not names or fit.signal in names:
                figure.axes[0].plot(MODELS, [fit.nrmse[one] for one in MODELS], "o-", label=fit.signal)
        figure.axes[0].set(yscale="log", ylabel="error over standard deviation")
        if figure.axes[0].lines:
            figure.axes[0].legend(fontsize="small")
        return figure

    def summary(self) -> list[tuple[str, ...]]:
        """The verdict, and a row for every number that was found."""
        return [(self.verdict, self.words), *self.rows()]
