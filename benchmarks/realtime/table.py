"""The page with all figures."""

from __future__ import annotations

import os
import platform
from pathlib import Path
from typing import Any

from benchmarks.realtime.host import Interruptions
from benchmarks.realtime.judge import Line


def machine() -> str:
    """Processor, cores that this process may use, kernel and Python in words."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    cores = f"{len(os.sched_getaffinity(0))} cores of {names[0] if names else platform.machine()}"
    return f"{cores}, Linux {platform.release()}, Python {platform.python_version()}"


def markdown(header: dict[str, Any], parts: dict[str, list[Line]]) -> str:
    """Return the page.

    Parameters
    ----------
    header
        Keys ``date``, ``machine``, ``load`` (load average at the start), ``spec``, ``duration``,
        ``interruptions``, before and after, and ``taken``, shares by heading.
    parts
        Lines under their headings.
    """
    lines = [
        "# The node graph against the clock and the exact engine",
        "",
        f"Made {header['date']} by `python -m benchmarks.realtime`: `{header['spec']}` for"
        f" {header['duration']:g} s on {header['machine']}; load average at the start {header['load']:.2f}.",
        "",
        "What the machine itself allows: a thread with real-time priority that only reads the clock was"
        f" interrupted for {_interrupted(header['interruptions'][0])} just before the runs, and for"
        f" {_interrupted(header['interruptions'][1])} just after them.",
    ]
    for heading, rows in parts.items():
        share = 100.0 * header["taken"][heading]
        meanwhile = f"A hypervisor gave {share:.2f} % of the cores' time to others meanwhile."
        lines += ["", f"## {heading}", "", meanwhile, "", "| | measured | asked | met |", "|---|---|---|---|"]
        lines += [f"| {r.what} | {r.value} | {r.asked} | {'yes' if r.met else '**no**'} |" for r in rows]
    return "\n".join(lines) + "\n"


def _interrupted(found: Interruptions) -> str:
    return f"at most {1e3 * found['longest']:.2f} ms, {100.0 * found['share']:.2f} % of the time"
