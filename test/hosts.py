"""Hosts for the tests: network namespaces of this machine, joined by a cable."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parents[1] / "scripts"
ADDRESSES = ("10.91.7.1", "10.91.7.2")


def ip(words: str) -> None:
    """Run the program ip."""
    subprocess.run(["ip", *words.split()], check=True, capture_output=True)


@contextmanager
def two_hosts() -> Iterator[tuple[str, str]]:
    """Names of two network namespaces that reach each other at `ADDRESSES`; skipped without any."""
    if os.geteuid() != 0 or shutil.which("ip") is None:
        pytest.skip("two hosts on one machine need root and the program ip")
    subprocess.run([SCRIPTS / "rthm", "--help"], check=True, capture_output=True)  # no registry in there
    names = f"rthm{os.getpid()}a", f"rthm{os.getpid()}b"
    cables = [f"{name[-8:]}c" for name in names]
    try:
        for name in names:
            ip(f"netns add {name}")
        ip(f"link add {cables[0]} netns {names[0]} type veth peer name {cables[1]} netns {names[1]}")
        for name, cable, address in zip(names, cables, ADDRESSES, strict=True):
            ip(f"-n {name} address add {address}/24 dev {cable}")
            ip(f"-n {name} link set {cable} up")
            ip(f"-n {name} link set lo up")
    except subprocess.CalledProcessError as error:
        pytest.skip(f"this machine has no network namespaces: {error.stderr.decode().strip()}")
    yield names
    for name in names:
        subprocess.run(["ip", "netns", "delete", name], check=False, capture_output=True)


def on(host: str, words: list, environment: dict[str, str]) -> subprocess.Popen[str]:
    """Start a program on a host."""
    return subprocess.Popen(
        ["ip", "netns", "exec", host, *map(str, words)],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
