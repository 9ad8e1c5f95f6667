"""Delays and clocks of a recorded test, as a result."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm.results import Column, Result, blank
from rthm_analysis.timing import TimingResult
from rthm_analysis.timing.links import distribution

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Timing(Result, TimingResult):
    """Delays and clocks of a recorded test.

    Attributes
    ----------
    links : dict of LinkTiming
        By name: ``use``, ``age`` and ``excess`` (n,) in s, ``lost``, ``late``.
    clocks : dict of ClockTiming
        By name.
    """

    def columns(self) -> dict[str, Column]:
        """A row for every link: mean age, how much older than scheduled (99th percentile), lost, late."""
        links = list(self.links.values())
        age = np.array([distribution(one.age)["mean"] for one in links], dtype=float)
        excess = np.array([distribution(one.excess)["p99"] for one in links], dtype=float)
        return {
            "link": Column(np.array(list(self.links)), ""),
            "age": Column(age, "s"),
            "excess_p99": Column(excess, "s"),
            "lost": Column(np.array([one.lost for one in links]), "1"),
            "late": Column(np.array([one.late for one in links]), "1"),
        }

    def plot(self, *names: str) -> Figure:
        """Draw by how much each sample was older at its use than scheduled.

        Parameters
        ----------
        *names
            Links; all when none is named.

        Returns
        -------
        matplotlib.figure.Figure
        """
        figure = blank(1)
        for name in names or self.links:
            figure.axes[0].plot(
                self.links[name].use, self.links[name].excess, ".", markersize=2.0, label=name
            )
        figure.axes[0].set(xlabel="t, s", ylabel="excess age, s")
        figure.axes[0].legend(fontsize="small")
        return figure

    def summary(self) -> list[tuple[str, ...]]:
        """A row for every link, the heading first."""
        return self.rows()
