"""What a bag says about one test."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.recording.host_clocks import HostClocks
from rthm_analysis.recording.table import LinkTable, Table, rows_of
from rthm_core.clock import NS
from rthm_core.errors import InputError
from rthm_core.events import Abort, abort_of
from rthm_core.spec import Spec
from rthm_core.topics import ACCELERATION, PLANT_STATE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rthm_core.compiled import Floats, Integers

ABSENT, UNUSABLE = "the bag has no topic", "the spec in the bag cannot be used"
"""Beginnings of the notes on a recording without a spec."""


@dataclass(frozen=True)
class Recording:
    """What a bag says about one test.

    Attributes
    ----------
    path : Path
        The bag.
    namespace : str
        Where its topics were, such as ``/rthm``.
    spec : Spec or None
        The spec in the bag; None when there is none, or one that cannot be read (`notes` then says why).
    spec_text : str
        The text of the topic ``spec``; empty when there is none.
    tables : dict of Table
        By relative topic name, such as ``plant/state``; only topics with samples.
    links : dict of LinkTable
        By link name, ``tau1`` to ``tau4``; only links with uses.
    start_ns : int
        Start of the test: the first stamp of ``plant/state``, tick 0 of every clock.
    notes : tuple of str
        What was missing, damaged or mended, one sentence each.
    diagnostics : dict of dict of str
        What each node last said of itself on ``/diagnostics``: values by name of the status and key.
    clocks : HostClocks
        Clocks of other hosts, as they were compared during the test.
    events : tuple of dict
        What was published on ``events``, in order (`rthm_core.events`).
    """

    path: Path
    namespace: str
    spec: Spec | None
    spec_text: str
    tables: dict[str, Table]
    links: dict[str, LinkTable]
    start_ns: int
    notes: tuple[str, ...]
    diagnostics: dict[str, dict[str, str]] = field(default_factory=dict)
    clocks: HostClocks = field(default_factory=HostClocks)
    events: tuple[dict[str, Any], ...] = ()

    @property
    def abort(self) -> Abort | None:
        """What ended the test before its time; None if nothing did."""
        aborts = (abort_of(event) for event in self.events)
        return next((abort for abort in aborts if abort is not None), None)

    @property
    def name(self) -> str:
        """Name for the eye: of its folder, or of the run that has it."""
        path = self.path.resolve()
        return path.parent.name if path.name == "bag" else path.name

    @property
    def plant(self) -> Table:
        """Samples of ``plant/state``."""
        return self.tables[PLANT_STATE]

    @property
    def duration(self) -> float:
        """Seconds from the first to the last sample of the plant."""
        return float(self.plant.stamp_ns[-1] - self.start_ns) / NS

    def seconds(self, stamps_ns: Integers) -> np.ndarray:
        """Seconds since the start of the test."""
        return (stamps_ns - self.start_ns) / NS

    def accelerations(self, names: Sequence[str]) -> Floats:
        """Accelerations (n, len(names)) of dofs at the samples of the plant, m/s^2; NaN where no
        accelerometer has a sample of that instant.
        """
        table, stamps = self.tables.get(ACCELERATION), self.plant.stamp_ns
        if table is None:
            return np.full((stamps.size, len(names)), np.nan)
        row, found = rows_of(table.stamp_ns, stamps)
        return np.where(found[:, None], table.columns("effort", names)[row], np.nan)

    def known_spec(self) -> Spec:
        """Return the spec; InputError when the bag has none that can be read."""
        if self.spec is None:
            damaged = next((note for note in self.spec_notes if UNUSABLE in note), "")
            raise InputError(
                f"The recording {self.path} contains no spec; give one with --spec. {damaged}".rstrip()
            )
        return self.spec

    @property
    def spec_notes(self) -> tuple[str, ...]:
        """Those of the notes that say why there is no spec."""
        return tuple(note for note in self.notes if note.startswith((ABSENT, UNUSABLE)))
