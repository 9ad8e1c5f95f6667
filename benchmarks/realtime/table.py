"""The page with all figures."""

from __future__ import annotations

import os
import platform
from pathlib import Path
from typing import Any

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
        Keys ``date``, ``machine``, ``load`` (load average at the start), ``spec``, ``duration``.
    parts
        Lines under their headings.
    """
    lines = [
        "# The node graph against the clock and the exact engine",
        "",
        f"Made {header['date']} by `python -m benchmarks.realtime`: `{header['spec']}` for"
        f" {header['duration']:g} s on {header['machine']}; load average at the start {header['load']:.2f}.",
    ]
    for heading, rows in parts.items():
        lines += ["", f"## {heading}", "", "| | measured | asked | met |", "|---|---|---|---|"]
        lines += [f"| {r.what} | {r.value} | {r.asked} | {'yes' if r.met else '**no**'} |" for r in rows]
    return "\n".join(lines) + "\n"
