"""A component on a test bench: what its force follows from."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rthm.recordings import Recorded, read
from rthm.results import Array, Column, Result
from rthm_analysis.component import ComponentFinding, identify_recordings

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from rthm_analysis.component import ComponentTest
    from rthm_analysis.component.fitting import Fitted


@dataclass(frozen=True, kw_only=True)
class Component(Result, ComponentFinding):
    """What the force of a component follows from; its fields are those of `ComponentFinding`.

    ``verdict`` is ``explained``, ``improved`` or ``unexplained``, ``words`` the answer in a sentence,
    ``terms`` the parts of the force with their values, ``lags`` how late the inputs act.
    """

    model: Fitted
    test: ComponentTest

    @property
    def predicted(self) -> Array:
        """Force (n,) of what was found along the recording that confirms it, N; NaN where nothing was."""
        if self.verdict == "unexplained":
            return np.full(self.test.t.size, np.nan)
        return np.asarray(self.model.force(self.test))

    def columns(self) -> dict[str, Column]:
        """Time, motion, force as measured and as found, and inputs, of the recording that confirms it."""
        test = self.test
        inputs = {name: Column(values, "") for name, values in test.inputs.items()}
        return {
            "t": Column(test.t, "s"),
            f"{self.motion}.position": Column(test.x, "m"),
            f"{self.motion}.velocity": Column(test.v, "m/s"),
            f"{self.force}.measured": Column(test.force, "N"),
            f"{self.force}.found": Column(self.predicted, "N"),
            **inputs,
        }

    def plot(self, *names: str) -> Figure:
        """Draw the force over displacement, speed and time, measured and as found; or columns over time.

        Parameters
        ----------
        *names
            Columns; when none is named, the loops.

        Returns
        -------
        matplotlib.figure.Figure
        """
        if names:
            return super().plot(*names)
        from rthm_analysis.report.component_picture import picture

        return picture(self, self.model, self.test)

    def summary(self) -> list[tuple[str, ...]]:
        """The verdict, and a row for every part of the force."""
        from rthm_analysis.component.words import lag_words, term_words

        parts = [(one.called, term_words(one)) for one in self.terms]
        return [(self.verdict, self.words), *parts, *((n, lag_words(n, lag)) for n, lag in self.lags.items())]


def component(
    bag: Recorded | Sequence[Recorded],
    motion: str = "",
    force: str = "",
    inputs: Sequence[str] = (),
    effects: Iterable[str | Path] = (),
) -> Component:
    """Find out what the force of a component follows from, motion in and force out.

    Parameters
    ----------
    bag : str, Path or Recording, or a sequence of these
        The recording, or several of one component: the last confirms what the others show.
    motion : str, optional
        Signal that is the imposed motion, where there are several.
    force : str, optional
        Signal that is the measured force, where there are several.
    inputs : sequence of str, optional
        Further inputs, such as a voltage; all that are there when absent.
    effects : iterable of str or Path
        Python files, or modules, that declare further kinds of effects to look for. They are executed.

    Returns
    -------
    Component

    Raises
    ------
    InputError
        If a signal is not there or nothing says which it is, or nothing moves.

    Examples
    --------
    >>> import rthm
    >>> found = rthm.component("bench/damper")
    >>> found.verdict, [one.called for one in found.terms]
    ('explained', ['damping', 'dry friction'])
    >>> picture = found.plot()
    """
    bags = bag if isinstance(bag, Sequence) and not isinstance(bag, str) else [bag]
    recorded = [read(one, effects) for one in bags]
    found, model, test = identify_recordings(recorded, motion, force, inputs)
    return Component.of(found, model=model, test=test)
