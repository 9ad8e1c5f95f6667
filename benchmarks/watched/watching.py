"""A dashboard with its page open."""

from __future__ import annotations

import json
import re
import signal
import statistics
import subprocess
import sys
import threading
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import cast

ANSWERS_WITHIN = 60.0
"""How long a dashboard may take to begin, s."""


@contextmanager
def dashboard(domain: int) -> Iterator[Callable[[], float]]:
    """A dashboard of a domain, and somebody who takes everything that it shows, as a page does.

    Yields
    ------
    callable
        Its share of a core while the test ran, the median of what it told so far.
    """
    command = [sys.executable, "-m", "rthm_bringup", "dashboard", "--port", "0", "--domain", str(domain)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        address = re.findall(r"http://\S+", process.stdout.readline())[0]
        costs: list[float] = []
        begun, place = threading.Event(), address.replace("/?", "/events?")
        threading.Thread(target=_read, args=(place, begun, costs), daemon=True).start()
        try:
            if not begun.wait(ANSWERS_WITHIN):
                raise RuntimeError("the dashboard does not answer; see what rthm dashboard says by itself.")
            yield lambda: _median(costs)
        finally:
            process.send_signal(signal.SIGINT)


def _median(costs: list[float]) -> float:
    if not costs:
        raise RuntimeError("the dashboard has not seen the test; give it more time with --duration.")
    return statistics.median(costs)


def _read(address: str, begun: threading.Event, costs: list[float]) -> None:
    with urllib.request.urlopen(address) as stream:
        for line in cast("Iterator[bytes]", stream):
            if line.startswith(b"data: {") and b'"state"' in line:
                begun.set()
                told = json.loads(line[6:])
                if told["state"] == "running" and told["cost"] is not None:
                    costs.append(told["cost"])
