"""A running test: its messages in, what is shown of it out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rthm_analysis.dashboard.ages import Ages
from rthm_analysis.dashboard.digits import rounded
from rthm_analysis.dashboard.fresh import TOPICS, Fresh, Waiting
from rthm_analysis.dashboard.motion import STEP, Motion
from rthm_analysis.dashboard.nearness import Nearness
from rthm_analysis.dashboard.told import Told
from rthm_analysis.dashboard.traces import Trace
from rthm_core.clock import NS
from rthm_core.topics import PLANT_STATE

if TYPE_CHECKING:
    from rthm_core.spec import Spec

CURVE_LENGTH = 20.0
"""Length of the curves, s."""

ENERGIES = ("E_num", "E_ff", "E_fx", "E_err", "E_damping", "E_load", "E_effects", "E_total")
"""Terms that are shown."""

STARTING, RUNNING, ABORTED, ENDED = "starting", "running", "aborted", "ended"
"""States of a test."""

__all__ = ["TOPICS", "Facts", "RunningTest"]


class Facts(NamedTuple):
    """What the nodes of a test know of it beyond the spec.

    Attributes
    ----------
    begin_ns : int or None
        Stamp of its start; None: it has not begun.
    whole : bool
        Whether this is the start, and not the first sample that was heard.
    duration : float
        s; 0: no end is known.
    hardware, dry_run : bool
        Whether the plant is a real machine, and whether no command is sent to it.
    """

    begin_ns: int | None = None
    whole: bool = True
    duration: float = 0.0
    hardware: bool = False
    dry_run: bool = False


class RunningTest:
    """A test as it goes on.

    Parameters
    ----------
    spec : Spec
        A loop.
    """

    def __init__(self, spec: Spec) -> None:
        self._spec, self._waiting = spec, Waiting()
        self.told = Told()
        self.motion = Trace(int(CURVE_LENGTH * NS / STEP))
        self.energy = Trace(int(CURVE_LENGTH * 10))
        self._over, self._facts = False, Facts()
        self._set(self._facts)

    @property
    def spec(self) -> Spec:
        """The test's spec."""
        return self._spec

    @property
    def begun(self) -> bool:
        """Whether samples of the test have been shown."""
        return not np.isnan(self._at)

    def learn(self, facts: Facts) -> None:
        """Take what the nodes know; another start is another test."""
        if facts != self._facts:
            self._set(facts)

    def take(self, topic: str, message: bytes) -> None:
        """Keep a message of one of `TOPICS` until the next look."""
        self._waiting.take(topic, message)

    def end(self) -> None:
        """Note that the test is over."""
        self._over = True

    def look(self) -> dict[str, Any]:
        """Take in what has come since the last look; return what is to be shown now."""
        begin = self._facts.begin_ns
        if begin is not None:
            self._add(self._waiting.look(begin), begin)
        return self._shown()

    def layout(self) -> dict[str, Any]:
        """What stays the same: names of the columns of both traces, and what pulls at what."""
        loop = self._spec.loop()
        pulls = zip(loop.actuator.names, loop.interface.plant_dof, loop.interface.numerical_dof, strict=True)
        return {
            "columns": self._motion.names,
            "energies": ["t", *ENERGIES],
            "pulls": [{"motor": motor, "plant": x1, "numerical": x2} for motor, x1, x2 in pulls],
            "dofs": list(loop.plant.dofs),
            "window": CURVE_LENGTH,
        }

    def _set(self, facts: Facts) -> None:
        if facts.begin_ns != self._facts.begin_ns and self._facts.begin_ns is not None:
            self._waiting = Waiting()
        for trace in (self.motion, self.energy):
            trace.clear()
        self._facts, self._at = facts, np.nan
        self._motion = Motion(self._spec, facts.whole)
        self._ages, self._nearness = Ages(self._spec), Nearness(self._spec, facts.hardware)
        self._counted, self._terms = -1, dict.fromkeys(ENERGIES, np.nan)

    def _add(self, fresh: Fresh, begin: int) -> None:
        rows = self._motion.rows(fresh, begin)
        self.motion.extend(rows.tolist())
        self._ages.add(fresh)
        self._nearness.add(fresh)
        self._add_energy(fresh, begin)
        plant = fresh.tables.get(PLANT_STATE)
        self._at = np.nan if plant is None else int(plant.stamp_ns[-1] - begin) / NS

    def _add_energy(self, fresh: Fresh, begin: int) -> None:
        table = fresh.tables.get("energy")
        if table is None:
            return
        new = table.rows(np.flatnonzero(table.stamp_ns > self._counted))
        if len(new):
            values, t = new.columns("effort", ENERGIES), (new.stamp_ns - begin) / NS
            self.energy.extend(np.column_stack([t, values]).tolist())
            self._counted, self._terms = int(new.stamp_ns[-1]), dict(zip(ENERGIES, values[-1], strict=True))

    def _shown(self) -> dict[str, Any]:
        state, words = self._state()
        links = [link | self.told.counts_of(link["name"]) for link in self._ages.told()]
        return {
            "state": state,
            "words": words,
            "at": rounded(self._at),
            "duration": self._facts.duration,
            "dry_run": self._facts.dry_run,
            "errors": self._errors(),
            "no_ideal": self._motion.why,
            "energy": {name: rounded(value) for name, value in self._terms.items()},
            "links": links,
            "clocks": self.told.clocks,
            "without_priority": self.told.without_priority,
            "limits": self._nearness.told(),
            "events": self.told.events,
        }

    def _state(self) -> tuple[str, str]:
        if self.told.abort is not None:
            after = " The motors are at rest." if self.told.rested else " The motors go where on_abort says."
            return ABORTED, self.told.abort.sentence.rstrip(".") + "." + after
        if self._over:
            return ENDED, "The test is over."
        if not self.begun:
            return STARTING, "The nodes of a test are starting."
        return (
            RUNNING,
            "The test is running; no command is sent (dry run)."
            if self._facts.dry_run
            else "The test is running.",
        )

    def _errors(self) -> list[Mapping[str, Any]]:
        dofs = self._spec.plant.dofs
        return [
            {"dof": dof} | {name: rounded(value) for name, value in error.as_dict().items()}
            for dof, error in zip(dofs, self._motion.error.errors(), strict=True)
        ]
