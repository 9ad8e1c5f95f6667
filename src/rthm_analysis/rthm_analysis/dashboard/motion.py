"""Motion and forces of a running test on one grid of instants, beside the ideal system."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.dashboard.fresh import Fresh
from rthm_analysis.dashboard.ideal import IdealMotion
from rthm_analysis.outcome.ideal import ErrorSoFar
from rthm_analysis.recording.table import hold
from rthm_core.clock import NS
from rthm_core.topics import FORCE_REFERENCE, NUMERICAL_STATE, PLANT_STATE

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec import Spec

STEP = NS // 50
"""Distance of the rows, ns: ten to a period of 5 Hz."""

LAG = NS // 20
"""How far the rows stay behind the newest sample, ns: other topics have come as far by then."""

UNHEARD_PERIODS = 3
"""Periods without a sample from which on none was heard."""

SIDES = (PLANT_STATE, NUMERICAL_STATE)
"""Topics of which the newer one tells how far the test has come."""

ROWS_AT_ONCE = 2000
"""Rows at once: of a longer pause only the end is shown."""


class Columns(NamedTuple):
    """Some columns of a topic, and the period of its samples, ns."""

    topic: str
    field: str
    names: tuple[str, ...]
    period: int


class Motion:
    """Rows of a test as it goes on.

    Parameters
    ----------
    spec : Spec
        A loop.
    whole : bool
        Whether t = 0 is the start of the test; the ideal motion is known only then.

    Attributes
    ----------
    names : list of str
        Columns of a row: ``t`` in s; positions of the plant in the test and ideally, of the numerical side
        and of the motors in m; force references and forces in N.
    error : ErrorSoFar
        Against the ideal system.
    """

    def __init__(self, spec: Spec, whole: bool) -> None:
        loop = spec.loop()
        plant, motors = loop.plant.dofs, loop.actuator.names
        td1, td2 = loop.timing.ns("td1"), loop.timing.ns("td2")
        self._columns = (
            Columns(PLANT_STATE, "position", plant, td1),
            Columns(NUMERICAL_STATE, "position", loop.numerical.dofs, td2),
            Columns(PLANT_STATE, "position", motors, td1),
            Columns(FORCE_REFERENCE, "effort", motors, td2),
            Columns(PLANT_STATE, "effort", motors, td1),
        )
        ends = ("", "", ".motor", ".reference", ".force")
        held = [
            [name + end for name in column.names] for column, end in zip(self._columns, ends, strict=True)
        ]
        self.names = ["t", *chain(*held), *(f"{dof}.ideal" for dof in plant)]
        self.ideal = IdealMotion(spec, STEP / NS)
        self.error = ErrorSoFar(len(plant))
        self._whole, self._dofs, self._next = whole, len(plant), 0

    @property
    def why(self) -> str:
        """Why the ideal motion is not known; empty: it is."""
        return self.ideal.why if self._whole else "the start of the test was not heard"

    def rows(self, fresh: Fresh, begin_ns: int) -> Floats:
        """Return the rows that are due, (rows, names); what nobody published is NaN."""
        first, stop = self._due(fresh, begin_ns)
        self._next = max(stop, self._next)
        instants = np.arange(first, stop, dtype=np.int64) * STEP
        held = [_held(fresh, column, instants + begin_ns) for column in self._columns]
        ideal = self.ideal.rows(first, stop) if self._whole else np.full((stop - first, self._dofs), np.nan)
        known = np.isfinite(held[0]).all(axis=1) & np.isfinite(ideal).all(axis=1)
        self.error.add(held[0][known] - ideal[known], ideal[known])
        return np.column_stack([instants / NS, *held, ideal])

    def _due(self, fresh: Fresh, begin_ns: int) -> tuple[int, int]:
        """Number of the first row that is due, and of the first that is not."""
        heard = [fresh.stamps(topic)[[0, -1]] for topic in SIDES if topic in fresh.tables]
        if not heard:
            return 0, 0
        stop = int(max(last for _, last in heard) - LAG - begin_ns) // STEP + 1
        first = -(int(begin_ns - min(first for first, _ in heard)) // STEP)
        first = max(self._next, first, stop - ROWS_AT_ONCE)
        return first, max(stop, first)


def _held(fresh: Fresh, column: Columns, at: Integers) -> Floats:
    """Values at some instants; NaN where samples were not heard, as a host that is busy leaves some out."""
    stamps = fresh.stamps(column.topic)
    if not stamps.size:
        return np.full((len(at), len(column.names)), np.nan)
    values = hold(stamps, fresh.columns(column.topic, column.field, column.names), at)
    age = at - hold(stamps, stamps, at)
    unheard = (age < 0) | (age > max(UNHEARD_PERIODS * column.period, STEP))
    return np.where(unheard[:, None], np.nan, values)
