"""Recordings of loops by the exact schedule, made in memory, on machines that may stand still."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from rthm_analysis.recording import LinkTable, Recording, Table
from rthm_core.schedule import newest_arrived
from rthm_core.spec import Spec, shipped_spec

from .conftest import START
from .loop import Stamps, stamps

DURATION = 20.0


def paper() -> Spec:
    return shipped_spec("paper")


def table(times: np.ndarray, names: tuple[str, ...], **columns: np.ndarray) -> Table:
    none = np.full((times.size, len(names)), np.nan)
    return Table(
        *(START + times,) * 3,
        names,
        **({"position": none, "velocity": none, "effort": none} | columns),
    )


def uses(spec: Spec, when: Stamps) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    timing = spec.loop().timing
    td1 = timing.ns("td1")
    regular = (when.command % timing.ns("td3") == 0) & (when.command_state >= 0)
    counted = when.tick_state >= 0
    return {
        "tau1": (when.command[regular], when.command_state[regular] * td1),
        "tau2": (when.tick[counted], when.tick_state[counted] * td1),
        "tau3": (when.reference_use, when.reference_used),
        "tau4": (when.motor_use, when.motor_command),
    }


def recording(true: Spec, duration: float = DURATION) -> Recording:
    """A test by the exact schedule: the plant moves at random, the numerical substructure stands still."""
    when, random = stamps(true, duration), np.random.default_rng(1)
    x1, v1 = random.normal(size=(2, when.sample.size + 1, 1))
    x1[-1], v1[-1] = 0.5, 0.0
    k2, c2 = true.interface.stiffness[0], true.interface.damping[0]
    force = -k2 * x1[when.tick_state] - c2 * v1[when.tick_state]
    told = np.where(when.command_reference[:, None] >= 0, force[when.command_reference], 0.0)
    u_d = x1[when.command_state] + told / true.k_tot[0]
    still = np.zeros((when.tick.size, 1))
    motor = np.full_like(x1[:-1], np.nan)
    tables = {
        "plant/state": table(
            when.sample,
            ("x1", "a1"),
            position=np.hstack([x1[:-1], motor]),
            velocity=np.hstack([v1[:-1], motor]),
        ),
        "numerical/state": table(when.tick, ("x2",), position=still, velocity=still, effort=still),
        "numerical/force_reference": table(when.tick, ("a1",), effort=force),
        "actuator/command": table(when.command, ("a1",), position=u_d, effort=told),
    }
    links = {n: LinkTable(START + u, START + s, *(START + u,) * 2) for n, (u, s) in uses(true, when).items()}
    return Recording(Path("bag"), "/rthm", None, "", tables, links, START, ())


def stalled(one: Recording, spec: Spec, seed: int, times: int = 20, lost: float = 0.0) -> Recording:
    """The same test on a machine that stands still some times; what is sent meanwhile arrives afterwards.

    A share of the states gets lost on tau1.
    """
    random, timing = np.random.default_rng(seed), spec.loop().timing
    begins = random.integers(0, int(DURATION * 1e9), times)
    ends = begins + random.integers(3_000_000, 40_000_000, times)

    def arrivals(sent: np.ndarray, tau: int) -> np.ndarray:
        arrival = sent + random.integers(100_000, 300_000, sent.size)
        for begin, end in sorted(zip(begins, ends, strict=True)):
            held = (arrival >= begin) & (arrival < end)
            arrival = np.where(held, end + random.integers(0, 200_000, sent.size), arrival)
        return np.maximum(arrival, sent + tau)

    tables = {
        name: replace(t, sent_ns=START + arrivals(t.stamp_ns - START, 0)) for name, t in one.tables.items()
    }
    links = {}
    for name, clock in (("tau1", "td3"), ("tau2", "td2")):
        sent = one.plant.stamp_ns - START
        sent = sent[random.random(sent.size) >= lost] if name == "tau1" else sent
        ticks = np.arange(0, int(DURATION * 1e9), timing.ns(clock))
        number = newest_arrived(np.arange(sent.size), arrivals(sent, timing.ns(name)), ticks)
        use, sample = START + ticks[number >= 0], START + sent[number[number >= 0]]
        links[name] = LinkTable(use, sample, use, use)
    for name in ("tau3", "tau4"):
        sample = one.links[name].sample_ns
        use = START + arrivals(sample - START, timing.ns(name))
        order = np.lexsort((sample, use))
        kept = order[sample[order] == np.maximum.accumulate(sample[order])]
        links[name] = LinkTable(use[kept], sample[kept], use[kept], use[kept])
    return replace(one, tables=tables, links=links)


def without_times_of_sending(one: Recording) -> Recording:
    tables = {name: replace(table, sent_ns=table.received_ns) for name, table in one.tables.items()}
    return replace(one, tables=tables)
