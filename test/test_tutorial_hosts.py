"""What the tutorial on three hosts prints; each host is a network namespace of this machine."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from subprocess import Popen

import pytest
from benchmarks.hosts import ADDRESSES, on
from pages import ROOT, Command, agrees, commands, shell_in

pytestmark = [pytest.mark.graph, pytest.mark.usefixtures("nothing_left")]
PAGE = ROOT / "docs" / "tutorials" / "three_hosts.md"
NAMES = ("leader", "plant", "numerical")
"""Prompts of the page, in the order of the addresses."""


@pytest.mark.parametrize("hosts", [3], indirect=True)
def test_the_tutorial_on_three_hosts_prints_what_its_commands_print(
    hosts: tuple[str, str, str], environment: dict[str, str], tmp_path: Path
) -> None:
    """Commands of the other hosts wait for the leader, whose commands follow each other."""
    variables, named = shell_in(tmp_path, environment), dict(zip(NAMES, hosts, strict=True))
    found = list(commands(PAGE))
    assert {one.host for one in found} == set(NAMES)
    with ExitStack() as ends:
        for one in found:
            shell = start(named[one.host], one, tmp_path, variables)
            ends.enter_context(shell)
            ends.callback(shell.terminate)
            if one.host == "leader":
                check(one, shell)


def start(host: str, one: Command, folder: Path, variables: dict[str, str]) -> Popen[str]:
    """Start a command on its host, in the folder."""
    return on(host, ["sh", "-c", f"cd '{folder}' && exec {one.words}"], variables)


def check(one: Command, shell: Popen[str]) -> None:
    """Wait for a command of the leader, and compare what it printed."""
    printed, complaints = shell.communicate(timeout=300)
    assert shell.returncode == 0, f"{one.words}: {complaints}"
    assert agrees(one.said, printed.splitlines()), f"{one.words} printed\n{printed}"


def test_the_addresses_of_the_tutorial_are_those_of_the_hosts() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert all(f"| `{name}` | {address} |" in text for name, address in zip(NAMES, ADDRESSES, strict=True))
