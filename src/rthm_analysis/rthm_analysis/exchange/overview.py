"""What was understood of a file: channels, units, ranges, resolution, and how often a reading is new."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.numbers import bare
from rthm_analysis.diagnosis.replay.readings import lattice
from rthm_analysis.diagnosis.replay.updates import own_readings
from rthm_analysis.exchange.columns import Columns
from rthm_analysis.exchange.mapping import ROLES, Wanted
from rthm_analysis.exchange.signals import unit_in_file
from rthm_analysis.exchange.stamps import are_gaps
from rthm_analysis.exchange.units import si_unit
from rthm_analysis.recording import Table
from rthm_core.clock import NS

if TYPE_CHECKING:
    from rthm_core.compiled import Floats


@dataclass(frozen=True)
class Understood:
    """One column, as it went into the bag.

    Attributes
    ----------
    role, name, column
        What it is of, and its heading in the file.
    file_unit, unit
        Of the file, and of the numbers here and in the bag.
    least, most, mean : float
        Of all values that are known.
    step : float or None
        Resolution of the sensor, where all values lie on such steps.
    readings : float
        New readings per sample: below 1 where a slow sensor was repeated or interpolated.
    """

    role: str
    name: str
    column: str
    file_unit: str
    unit: str
    least: float
    most: float
    mean: float
    step: float | None
    readings: float

    @property
    def words(self) -> str:
        """What it is, in a sentence of its own."""
        said = (
            f"{self.role} {self.name} is {self.column} in {self.file_unit}: {bare(self.least)} to "
            f"{bare(self.most)} {self.unit}, mean {bare(self.mean)} {self.unit}"
        )
        steps = f", in steps of {bare(self.step)} {self.unit}" if self.step else ""
        seldom = f", {bare(self.readings)} readings per sample" if self.readings < 1.0 else ""
        return said + steps + seldom


def understood(columns: Columns, wanted: Wanted, tables: Mapping[str, Table]) -> Iterator[Understood]:
    """Every signal of the tables, by topic, that were made of columns."""
    for one in wanted.signals:
        role, file_unit = ROLES[one.role], unit_in_file(columns, one, wanted)
        values = tables[role.topic].columns(role.field, [one.name])[:, 0]
        known = values[np.isfinite(values)]
        yield Understood(
            one.role, one.name, one.column, file_unit, si_unit(file_unit, role.unit),
            float(known.min()), float(known.max()), float(known.mean()), lattice(values), _readings(values),
        )  # fmt: skip


def _readings(values: Floats) -> float:
    kept, _ = own_readings(values)
    return 1.0 if kept is None else float(kept.mean())


def sampling_words(table: Table) -> str:
    """How often was sampled: intervals over the time that they take."""
    if len(table) < 2:
        return "one sample"
    seconds = float(table.stamp_ns[-1] - table.stamp_ns[0]) / NS
    gaps = int(np.count_nonzero(are_gaps(np.diff(table.stamp_ns))))
    lost = f", with {gaps} gaps" if gaps > 1 else ", with a gap" if gaps else ""
    return f"{bare((len(table) - 1) / seconds, 6)} samples per second{lost}"
