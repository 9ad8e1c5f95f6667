"""Pages of the documentation as programs: the commands that stand in them, and what they are said to "
"print."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[1]
SPECS = ROOT / "src" / "rthm_core" / "rthm_core" / "spec" / "shipped"
BLOCK = re.compile(r"^```console\n(.*?)^```$", re.DOTALL | re.MULTILINE)
PROMPT = re.compile(r"^(\w*)\$ ", re.MULTILINE)
FILE = re.compile(r'^```\w+ title="([^"/]+)"\n(.*?)^```$', re.DOTALL | re.MULTILINE)
NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?")


class Command(NamedTuple):
    """A command of a page, the host before whose prompt it stands, and the lines that it is said to print."""

    host: str
    words: str
    said: list[str]


def commands(page: Path) -> Iterator[Command]:
    """Every command of a page; its host is empty where the page has but one."""
    for block in BLOCK.findall(page.read_text(encoding="utf-8")):
        parts = PROMPT.split(block)[1:]
        for host, part in zip(parts[::2], parts[1::2], strict=True):
            words, *said = part.rstrip("\n").split("\n")
            yield Command(host, words, said)


def same(said: str, printed: str) -> bool:
    """Whether two lines have the same words and, but for rounding in the last digits, the same numbers."""
    if NUMBER.sub("#", said).split() != NUMBER.sub("#", printed).split():
        return False
    pairs = zip(NUMBER.findall(said), NUMBER.findall(printed), strict=True)
    return all(float(a) == pytest.approx(float(b), rel=1e-5, abs=1e-9) for a, b in pairs)


def agrees(said: list[str], printed: list[str]) -> bool:
    """Whether the lines are those that were printed; `...` stands for any number of lines."""
    if not said:
        return not printed
    if said[0] == "...":
        return any(agrees(said[1:], printed[k:]) for k in range(len(printed) + 1))
    return bool(printed) and same(said[0], printed[0]) and agrees(said[1:], printed[1:])


def shell_in(folder: Path, environment: dict[str, str]) -> dict[str, str]:
    """Environment in which the words of a page are found: `rthm`, which is put into the folder, and "
    "$SPECS."""
    (folder / "rthm").write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m rthm_bringup "$@"\n')
    (folder / "rthm").chmod(0o755)
    path = os.pathsep.join([str(folder), environment.get("PATH", os.defpath)])
    return environment | {"PATH": path, "SPECS": str(SPECS)}


def follow(page: Path, folder: Path, environment: dict[str, str]) -> None:
    """Write the files of a page, run its commands, and compare what they print with what it says."""
    variables = shell_in(folder, environment)
    for name, text in FILE.findall(page.read_text(encoding="utf-8")):
        (folder / name).write_text(text, encoding="utf-8")
    found = list(commands(page))
    assert found
    for one in found:
        done = subprocess.run(
            one.words, shell=True, cwd=folder, env=variables, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, f"{one.words}: {done.stderr}"
        assert agrees(one.said, done.stdout.splitlines()), f"{one.words} printed\n{done.stdout}"
