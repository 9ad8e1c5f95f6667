"""A recording beside the exact engine, and the payloads of a recording."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from mcap.reader import make_reader

from rthm_analysis.recording import Recording
from rthm_core.engine import simulate
from rthm_core.schedule import Schedule
from rthm_core.spec import Spec

OF_THE_WALL_CLOCK = ("/diagnostics", "/rthm/energy")
"""Topics of who only watches: they tell how busy the host is, so they differ from run to run."""


def worst_difference(recording: Recording, spec: Spec, duration: float) -> float:
    """Largest difference of any recorded position from the exact engine's at that instant, m.

    Parameters
    ----------
    recording
        A run in simulated time.
    spec
        Its test.
    duration
        Its length, s.
    """
    schedule, worst = Schedule(spec), 0.0
    for topic, period, what in (
        ("plant/state", schedule.td1, "plant_position"),
        ("numerical/state", schedule.td2, "numerical_position"),
    ):
        table, exact = recording.tables[topic], simulate(spec, duration, period / 1e9, energies=False)
        row = (table.stamp_ns - recording.start_ns) // period
        columns = getattr(exact, what).shape[1]
        worst = max(worst, float(np.abs(table.position[:, :columns] - getattr(exact, what)[row]).max()))
    return worst


def exact_energies(spec: Spec, duration: float) -> dict[str, float]:
    """Energies, J, at the last sample of a test of `duration` s by the exact engine."""
    period = Schedule(spec).td1
    run = simulate(spec, duration, period / 1e9)
    last = round(duration * 1e9) // period
    energies = {name: float(values[last]) for name, values in run.energies.items()}
    return energies | {"E_err": sum(energies[term] for term in ("E_num", "E_ff", "E_fx"))}


def payloads(bag: Path) -> dict[str, list[bytes]]:
    """Bytes of every message of the loop in a recording, by topic, in order."""
    found: dict[str, list[bytes]] = {}
    for file in sorted(bag.glob("*.mcap")):
        with file.open("rb") as stream:
            for _, channel, message in make_reader(stream).iter_messages():
                found.setdefault(channel.topic, []).append(message.data)
    return {topic: data for topic, data in found.items() if topic not in OF_THE_WALL_CLOCK}
