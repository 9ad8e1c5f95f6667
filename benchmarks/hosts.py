"""Hosts on one machine: network namespaces, each with a cable to a switch."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

SCRIPTS = Path(__file__).parents[1] / "scripts"
ADDRESSES = ("10.91.7.1", "10.91.7.2", "10.91.7.3")
"""Of the hosts, in order."""


class NoHostsError(Exception):
    """No network namespaces on this machine; the message says why."""


def ip(words: str) -> None:
    """Run the program ip."""
    subprocess.run(["ip", *words.split()], check=True, capture_output=True)


@contextmanager
def hosts(count: int = 2) -> Iterator[tuple[str, ...]]:
    """Names of network namespaces that reach each other at `ADDRESSES`.

    Raises
    ------
    NoHostsError
        Where they cannot be made.
    """
    if os.geteuid() != 0 or shutil.which("ip") is None:
        raise NoHostsError("several hosts on one machine need root and the program ip")
    subprocess.run([SCRIPTS / "rthm", "--help"], check=True, capture_output=True)  # no registry in there
    names = tuple(f"rthm{os.getpid()}{letter}" for letter in "abc"[:count])
    try:
        _wire(names)
        yield names
    finally:
        for name in (*names, switch_of(names[0])):
            with suppress(subprocess.CalledProcessError):
                ip(f"netns delete {name}")


def _wire(names: Sequence[str]) -> None:
    """Make the hosts, and a switch that each has a cable to; NoHostsError where that is not possible."""
    try:
        _try_to_wire(names)
    except subprocess.CalledProcessError as error:
        raise NoHostsError(
            f"this machine has no network namespaces: {error.stderr.decode().strip()}"
        ) from error


def _try_to_wire(names: Sequence[str]) -> None:
    switch = switch_of(names[0])
    for name in (switch, *names):
        ip(f"netns add {name}")
    ip(f"-n {switch} link add bridge type bridge")
    ip(f"-n {switch} link set bridge up")
    for name, address in zip(names, ADDRESSES, strict=False):
        ip(f"link add cable netns {name} type veth peer name {port_of(name)} netns {switch}")
        ip(f"-n {switch} link set {port_of(name)} master bridge")
        ip(f"-n {switch} link set {port_of(name)} up")
        ip(f"-n {name} address add {address}/24 dev cable")
        ip(f"-n {name} link set cable up")
        ip(f"-n {name} link set lo up")


def switch_of(name: str) -> str:
    """Network namespace of the switch that a host has its cable to."""
    return f"{name[:-1]}s"


def port_of(name: str) -> str:
    """Where the cable of a host ends at the switch."""
    return f"port{name[-1]}"


def plug(name: str, state: str) -> None:
    """Pull the cable of a host (``down``), or put it back (``up``)."""
    ip(f"-n {switch_of(name)} link set {port_of(name)} {state}")


def command_on(host: str, words: Sequence[object]) -> list[str]:
    """Command line that runs a program on a host."""
    return ["ip", "netns", "exec", host, *map(str, words)]


def on(host: str, words: Sequence[object], environment: Mapping[str, str]) -> subprocess.Popen[str]:
    """Start a program on a host."""
    return subprocess.Popen(
        command_on(host, words),
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
