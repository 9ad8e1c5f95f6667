"""All outcomes as a page."""

from __future__ import annotations

from typing import Any

from benchmarks.faults.catalogue import FAULTS, Fault

HEAD = """# Faults of a running test

Made {date} by `python -m benchmarks.faults --out docs/faults` on {machine}; load average {load}:
{count} of {all} faults, {good} as demanded.

Each fault is made in a test of its own in real time, with a driver of somebody else
(`test/programs/driver.py`) in place of the plant. A test that does not end as demanded and was disturbed, as
it ended before its fault or the host stalled for more than 0.2 s, is made again, three times at most:
that happened to {again}. Limits: rate {rate:g} m/s, ramp {ramp:g} s, stale {stale:g} s, heartbeat
{heartbeat:g} s.

- **step**: largest step of a command over `limits.rate` x the time since the last one, the lesser of what
  the stamps and the clock say; at most 1.
- **speed**: largest speed of the motor as its driver moved it, m/s.
- **rest**: time from the fault to the last move of the motor, s; where the fault has no date (*), from the
  abort. Where the driver is on another host, to the last move of the command. Allowed is detection (`stale`;
  `heartbeat`; 0.25 s for a frozen sensor; at once where a figure is wrong) + ramp + 0.1 s. A second publisher
  begins with the first sample that it sends to anybody who is connected. A motor whose controller is gone is
  held by its driver.
- **stall**: how long the host kept a thread with real-time priority waiting within that time, s, stalls
  above 1 ms; allowed on top.
- **status** 0: the test went on within its limits, and nothing of its recording is missing. Who gets no more
  memory may need none.
- **told**: where the abort is told: j in the JSON, p on the page, b in the bag.
"""
TITLES = "| fault | status | limit | what is said | step | speed | rest | allowed | stall | told | |"


def markdown(header: dict[str, Any], rows: list[dict[str, Any]]) -> str:
    """Return the page.

    Parameters
    ----------
    header
        Keys ``date``, ``machine``, ``load``, and the limits.
    rows
        Outcomes, as dictionaries.
    """
    by_name = {row["name"]: row for row in rows}
    good = sum(not row["complaints"] for row in rows)
    again = ", ".join(f"{row['name']} ({row['attempts']})" for row in rows if row["attempts"] > 1) or "none"
    lines = [HEAD.format(**header, count=len(rows), all=len(FAULTS), good=good, again=again)]
    for group in dict.fromkeys(fault.group for fault in FAULTS):
        made = [fault for fault in FAULTS if fault.group == group and fault.name in by_name]
        if made:
            lines += [f"## {group}", "", TITLES, "|---" * 11 + "|"]
            lines += [*(_line(fault, by_name[fault.name]) for fault in made), ""]
    return "\n".join(lines)


def _line(fault: Fault, row: dict[str, Any]) -> str:
    rest = _number(row["rest"]) + ("" if fault.way.dated or row["rest"] is None else " *")
    told = "".join(place[0] for place in row["told"])
    verdict = "**" + "; ".join(row["complaints"]) + "**" if row["complaints"] else ""
    cells = [
        fault.what, _status(row["status"]), row["limit"] or "", row["words"].replace("|", "/"),
        _number(row["step"]), _number(row["speed"]), rest, _number(row["allowed"]),
        _number(row["stalled"] or None), told, verdict,
    ]  # fmt: skip
    return "| " + " | ".join(cells) + " |"


def _status(status: int) -> str:
    return "killed" if status < 0 else str(status)


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.3f}"
