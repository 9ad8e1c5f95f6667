"""The dashboard beside a run: found by itself, true, and able to end the test."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

pytestmark = [pytest.mark.graph, pytest.mark.usefixtures("nothing_left")]
RTHM = [sys.executable, "-m", "rthm_bringup"]
PLACE = ["--namespace", f"/shown_{os.getpid()}"]


@pytest.fixture
def address(environment: dict[str, str], tmp_path: Path) -> Iterator[str]:
    """A dashboard's address; at its end it writes shown.json."""
    command = [*RTHM, "dashboard", *PLACE, "--port", "0", "--json", str(tmp_path / "shown.json")]
    anywhere = {name: value for name, value in environment.items() if name != "ROS_DOMAIN_ID"}
    with subprocess.Popen(command, env=anywhere, stdout=subprocess.PIPE, text=True) as dashboard:
        assert dashboard.stdout is not None
        yield re.findall(r"http://\S+", dashboard.stdout.readline())[0]
        dashboard.send_signal(signal.SIGINT)
        assert dashboard.wait(30) == 0
    assert json.loads((tmp_path / "shown.json").read_text())["state"] in ("ended", "aborted")


def shown(address: str, until: Callable[[dict], bool]) -> dict:
    """The first snapshot for which something is true."""
    deadline = time.monotonic() + 240.0
    with urllib.request.urlopen(address.replace("/?", "/events?"), timeout=60) as stream:
        for line in stream:
            assert time.monotonic() < deadline
            if line.startswith(b"data: {") and b'"state"' in line and until(data := json.loads(line[6:])):
                return data
    raise AssertionError("the dashboard has gone")


def pressed(address: str) -> int:
    """Press the button of the page; return the status of the answer."""
    place, token = address.split("/?token=")
    request = urllib.request.Request(f"{place}/abort", method="POST", headers={"X-Token": token})
    with urllib.request.urlopen(request, timeout=30) as answer:
        return answer.status


def test_a_run_is_found_shown_aborted_and_becomes_its_report(
    environment: dict[str, str], tmp_path: Path, address: str
) -> None:
    assert shown(address, lambda data: True)["state"] == "waiting"
    out = tmp_path / "out"
    command = [*RTHM, "run", "paper", *PLACE, "--duration", "60", "--out", str(out), "--json", "-"]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as run:
        seen = shown(address, lambda data: data["state"] == "running" and data["at"] > 2.0)
        assert seen["duration"] == 60.0
        assert seen["no_ideal"] == ""
        assert 0.05 < seen["errors"][0]["nrmse"] < 0.5
        assert seen["energy"]["E_fx"] < 0.0
        for link in seen["links"]:
            assert link["delay"] <= link["mean"]
        assert seen["can_abort"]
        assert pressed(address) == 200
        aborted = shown(address, lambda data: data["state"] == "aborted")
        assert "asked for by the service actuator/abort" in aborted["words"]
        result, _ = run.communicate(timeout=120)
        assert run.returncode == 3
    assert json.loads(result)["abort"]["limit"] == "operator"
    told = shown(address, lambda data: bool(data["report"]) and data["report"]["ready"])["report"]
    assert told["words"] == f"Its report is {out / 'report.html'}."
    with urllib.request.urlopen(address.replace("/?", "/report?"), timeout=30) as page:
        assert page.read() == (out / "report.html").read_bytes()
