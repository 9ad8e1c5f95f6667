"""The ledger of a running test, fed with messages as they come from the middleware.

Messages wait as raw bytes and are decoded some times a second, all at once and by the code that reads a
recording, so that listening costs little and the energy balance of a test and of its recording is the same.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from rthm_analysis.energy import EnergyLedger, Rows
from rthm_analysis.recording.raw import RawTopic
from rthm_analysis.recording.table import Table, joint_table, link_table
from rthm_core.clock import NS
from rthm_core.energy import TERMS, with_error
from rthm_core.spec import Spec
from rthm_core.topics import COMMAND, JOINT_STATE, NUMERICAL_STATE, PLANT_STATE, TIME_REFERENCE, link_topic

TOPICS = {
    PLANT_STATE: JOINT_STATE,
    NUMERICAL_STATE: JOINT_STATE,
    COMMAND: JOINT_STATE,
    link_topic("tau2"): TIME_REFERENCE,
    link_topic("tau4"): TIME_REFERENCE,
}
"""What the balance needs, by relative name."""

LAG_NS = NS // 2
"""How far the balance stays behind the newest sample: a message of an older one has come by then."""

FAR_NS = 600 * NS
"""A stamp that is this far ahead of the newest sample is wrong, and is not waited for."""


class LiveLedger:
    """Energy balance of a running test.

    Parameters
    ----------
    spec : Spec
        A complete loop.
    begin_ns : int
        Stamps before this instant do not belong to the test; 0: all do.
    """

    def __init__(self, spec: Spec, begin_ns: int = 0) -> None:
        self._spec, self._begin = spec, begin_ns
        self._waiting = self._empty()
        self._ledger: EnergyLedger | None = None
        self._first: np.ndarray | None = None
        self._newest = 0
        self._last: Rows | None = None

    def take(self, topic: str, message: bytes) -> None:
        """Keep a message of one of `TOPICS`."""
        self._waiting[topic].append(0, message)

    def advance(self, *, final: bool = False) -> tuple[int, dict[str, float]] | None:
        """Count what has come; return the stamp in ns to which the balance belongs, and every term in J.

        Parameters
        ----------
        final : bool
            Nothing more comes: count everything.
        """
        if self._ledger is None and not self._open(final=final):
            return None
        assert self._ledger is not None
        waiting, self._waiting = self._waiting, self._empty()
        self._add(self._ledger, waiting)
        rows = self._ledger.advance(None if final else self._newest - LAG_NS)
        if rows.stamp_ns.size:
            self._first = rows.total[:1] if self._first is None else self._first
            self._last = rows
        return self._told() if self._last is not None else None

    @staticmethod
    def _empty() -> dict[str, RawTopic]:
        return {name: RawTopic(name, kind) for name, kind in TOPICS.items()}

    def _open(self, *, final: bool) -> bool:
        """Begin with the first sample of the plant in the test, once none before it can still come."""
        stamps = self._table(self._waiting[PLANT_STATE]).stamp_ns
        if not stamps.size or (stamps[-1] - stamps[0] < LAG_NS and not final):
            return False
        self._ledger = EnergyLedger(self._spec, int(stamps[0]), self._spec.loop().timing.td1)
        return True

    def _add(self, ledger: EnergyLedger, waiting: dict[str, RawTopic]) -> None:
        loop = self._spec.loop()
        plant, numerical, command = (self._table(waiting[name]) for name in list(TOPICS)[:3])
        if len(plant):
            self._newest = max(self._newest, int(plant.stamp_ns[-1]))
        ledger.add_plant(
            plant.stamp_ns, *(plant.columns(f, loop.plant.dofs) for f in ("position", "velocity", "effort"))
        )
        dofs, names = loop.numerical.dofs, loop.actuator.names
        ledger.add_numerical(
            numerical.stamp_ns, *(numerical.columns(f, dofs) for f in ("position", "velocity"))
        )
        ledger.add_commands(command.stamp_ns, *(command.columns(f, names) for f in ("position", "effort")))
        for name in ("tau2", "tau4"):
            link = link_table(waiting[link_topic(name)])[0]
            ledger.add_uses(name, link.use_ns, link.sample_ns)

    def _table(self, topic: RawTopic) -> Table:
        table = joint_table(topic)[0]
        table = table.rows(np.flatnonzero(table.stamp_ns >= self._begin))
        until = (self._newest or int(table.stamp_ns.min(initial=np.iinfo(np.int64).max - FAR_NS))) + FAR_NS
        return table.rows(np.flatnonzero(table.stamp_ns <= until))

    def _told(self) -> tuple[int, dict[str, float]]:
        assert self._last is not None and self._first is not None
        work = dict(zip(TERMS, self._last.work[-1].tolist(), strict=True))
        total = float(self._last.total[-1])
        terms: dict[str, Any] = with_error(work) | {"E_total": total}
        balance = total - float(self._first[0]) - sum(work.values())
        return int(self._last.stamp_ns[-1]), terms | {"balance_error": balance}
