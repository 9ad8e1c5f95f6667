"""A recording on one clock: stamps of parts on other hosts, put right by what was measured of them."""

from __future__ import annotations

from dataclasses import replace

from rthm_analysis.recording.reading import PLANT_STATE, Recording
from rthm_core.clocks import ENDS

OWNERS = {
    PLANT_STATE: "plant",
    "numerical/state": "numerical",
    "numerical/force_reference": "numerical",
    "actuator/command": "actuator",
}
"""Node that stamps the samples of a topic."""


def synchronised(recording: Recording) -> Recording:
    """Return the recording with all stamps by the leader's clock.

    A sample and its use keep belonging to each other, to the nanosecond. Ticks no longer lie on the common
    grid of the clocks: the grid of a part is off it by as much as its clock was.
    """
    clocks = recording.clocks
    if not clocks.nodes:
        return recording
    tables, links = dict(recording.tables), dict(recording.links)
    for name, table in tables.items():
        owner = OWNERS.get(name, "")
        tables[name] = replace(table, stamp_ns=table.stamp_ns - clocks.lead_ns(owner, table.stamp_ns))
    for name, link in links.items():
        sender, receiver = ENDS[name]
        use = link.use_ns - clocks.lead_ns(receiver, link.use_ns)
        links[name] = replace(
            link, use_ns=use, sample_ns=link.sample_ns - clocks.lead_ns(sender, link.sample_ns)
        )
    start = int(tables[PLANT_STATE].stamp_ns[0])
    return replace(recording, tables=tables, links=links, start_ns=start)
