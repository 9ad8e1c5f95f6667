"""A recording on one clock: stamps of parts on other hosts, put right by what was measured of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.recording.recording import Recording
from rthm_analysis.recording.table import LinkTable, Table
from rthm_core.clock import NS
from rthm_core.clocks import ENDS, TICKS
from rthm_core.compiled import Integers
from rthm_core.topics import ACCELERATION, COMMAND, FORCE_REFERENCE, NUMERICAL_STATE, PLANT_STATE

if TYPE_CHECKING:
    from rthm_core.spec import Spec

OWNERS = {
    PLANT_STATE: "plant",
    ACCELERATION: "plant",
    NUMERICAL_STATE: "numerical",
    FORCE_REFERENCE: "numerical",
    COMMAND: "actuator",
}
"""Node that stamps the samples of a topic."""

Lead = Callable[[str, Integers], Integers]
"""By how much a node's clock is ahead at instants of its own clock, ns."""


def as_ticked(recording: Recording) -> Recording:
    """Return the recording with stamps by those clocks by which its ticks are at ``k * period``.

    Nodes that wait for instants of their own clocks tick by these, and so do their delays: what was wrong
    then is in the ages on the links, which `HostClocks` corrects, and in what happened at one time
    (`synchronised`). Where only the stamps were wrong, the ticks are regular on one clock alone: there all
    stamps are put on it, once for all who read them.
    """
    if not recording.clocks.nodes or recording.spec is None or not recording.spec.is_loop:
        return recording
    on_one = synchronised(recording)
    if off_ticks(recording, recording.spec) <= off_ticks(on_one, recording.spec):
        return recording
    return _as_near_as_known(on_one, recording.spec)


def synchronised(recording: Recording) -> Recording:
    """Return the recording with all stamps by the leader's clock.

    A sample and its use keep belonging to each other, to the nanosecond. Where parts ticked by clocks of
    their own, their ticks are then off the common grid by as much as their clocks were.
    """
    clocks = recording.clocks
    if not clocks.nodes or clocks.applied:
        return recording
    return replace(_moved(recording, clocks.lead_ns), clocks=replace(clocks, applied=True))


def off_ticks(recording: Recording, spec: Spec) -> float:
    """Mean distance of the samples of all parts from the ticks of the spec, in periods."""
    timing, away = spec.loop().timing, _away(recording, spec)
    return sum(float(np.abs(ns).mean()) / timing.ns(name) for name, ns in away.items() if ns.size)


def _away(recording: Recording, spec: Spec) -> dict[str, Integers]:
    """By how much samples come after the nearest tick of their clock, ns."""
    away, timing = {}, spec.loop().timing
    for name, topic in TICKS.items():
        if topic in recording.tables:
            since, period = recording.tables[topic].stamp_ns - recording.start_ns, timing.ns(name)
            away[name] = (since + period // 2) % period - period // 2
    return away


def _as_near_as_known(recording: Recording, spec: Spec) -> Recording:
    """Put parts that are off their ticks by no more than the clocks may be wrong upon their ticks."""
    unsure = max(float(np.median(clock.uncertainty)) for clock in recording.clocks.nodes.values()) * NS
    away = {OWNERS[TICKS[name]]: int(np.median(ns)) for name, ns in _away(recording, spec).items()}
    return _moved(
        recording,
        lambda owner, at: np.full(at.shape, away.get(owner, 0) * (abs(away.get(owner, 0)) <= unsure)),
    )


def _moved(recording: Recording, ahead: Lead) -> Recording:
    """Take off all stamps and times of sending what their owner is `ahead` by."""
    tables = {name: _table(table, OWNERS.get(name, ""), ahead) for name, table in recording.tables.items()}
    links = {name: _link(link, *ENDS[name], ahead) for name, link in recording.links.items()}
    start = int(tables[PLANT_STATE].stamp_ns[0])
    return replace(recording, tables=tables, links=links, start_ns=start)


def _table(table: Table, owner: str, ahead: Lead) -> Table:
    told = (table.sent_ns != table.received_ns).any()
    sent = table.sent_ns - ahead(owner, table.sent_ns) if told else table.sent_ns
    return replace(table, stamp_ns=table.stamp_ns - ahead(owner, table.stamp_ns), sent_ns=sent)


def _link(link: LinkTable, sender: str, receiver: str, ahead: Lead) -> LinkTable:
    told = (link.sent_ns != link.received_ns).any()
    return replace(
        link,
        use_ns=link.use_ns - ahead(receiver, link.use_ns),
        sample_ns=link.sample_ns - ahead(sender, link.sample_ns),
        sent_ns=link.sent_ns - ahead(receiver, link.sent_ns) if told else link.sent_ns,
    )
