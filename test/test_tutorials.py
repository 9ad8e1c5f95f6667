"""What the tutorials and how-to pages print is what the commands print."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from rthm_analysis.stability import spectral_radius
from rthm_core.spec import apply, shipped_spec

pytestmark = pytest.mark.usefixtures("nothing_left")
ROOT = Path(__file__).parents[1]
PAGES = [*sorted((ROOT / "docs" / "tutorials").glob("*.md")), ROOT / "docs" / "how-to" / "compare-tests.md"]
EFFECT = ROOT / "docs" / "how-to" / "add-an-effect.md"
SPECS = ROOT / "src" / "rthm_core" / "rthm_core" / "spec" / "shipped"
BLOCK = re.compile(r"^```console\n(.*?)^```$", re.DOTALL | re.MULTILINE)
FILE = re.compile(r'^```\w+ title="([^"/]+)"\n(.*?)^```$', re.DOTALL | re.MULTILINE)
WORST = """
import numpy, rthm
spec = rthm.load("rig.yaml")
recorded, run = rthm.read("rig/bag"), rthm.simulate(spec, 20.0, sample=spec.timing.td2)
table = recorded.tables["numerical/state"]
tick = numpy.rint(recorded.seconds(table.stamp_ns) / spec.timing.td2).astype(int)
print(abs(table.position - run.numerical_position[tick]).max())
"""
"""Largest difference between node and engine of x2, which is measured without noise, m."""

NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?")


def commands(page: Path) -> Iterator[tuple[str, list[str]]]:
    """Every command of a page with the lines that it is said to print."""
    for block in BLOCK.findall(page.read_text(encoding="utf-8")):
        for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
            command, *said = part.rstrip("\n").split("\n")
            yield command, said


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


def follow(page: Path, folder: Path, environment: dict[str, str]) -> None:
    """Write the files of a page, run its commands, and compare what they print with what it says."""
    (folder / "rthm").write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m rthm_bringup "$@"\n')
    (folder / "rthm").chmod(0o755)
    path = os.pathsep.join([str(folder), environment.get("PATH", os.defpath)])
    variables = environment | {"PATH": path, "SPECS": str(SPECS)}
    for name, text in FILE.findall(page.read_text(encoding="utf-8")):
        (folder / name).write_text(text, encoding="utf-8")
    told = list(commands(page))
    assert told
    for command, said in told:
        done = subprocess.run(
            command, shell=True, cwd=folder, env=variables, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, f"{command}: {done.stderr}"
        assert agrees(said, done.stdout.splitlines()), f"{command} printed\n{done.stdout}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_tutorial_prints_what_its_commands_print(
    environment: dict[str, str], tmp_path: Path, page: Path
) -> None:
    follow(page, tmp_path, environment)


def test_an_effect_of_ones_own_is_found_by_name_and_moves_nodes_as_the_engine(
    environment: dict[str, str], tmp_path: Path
) -> None:
    follow(EFFECT, tmp_path, environment)
    variables = environment | {"PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-c", WORST]
    done = subprocess.run(command, cwd=tmp_path, env=variables, check=True, capture_output=True, text=True)
    assert float(done.stdout) < 1e-9


def test_the_factors_of_the_first_tutorial_are_where_stability_is_lost() -> None:
    text = (ROOT / "docs" / "tutorials" / "first_test.md").read_text(encoding="utf-8")
    plain, predicted = (float(one) for one in re.findall(r"factor of (\d+\.\d+)", text))
    paper = shipped_spec("paper")
    for spec, factor in ((paper, plain), (apply(paper, {"actuator.compensator": "polynomial"}), predicted)):
        assert spectral_radius(spec.scaled_timing(round(factor - 0.01, 3))) < 1.0
        assert spectral_radius(spec.scaled_timing(round(factor + 0.01, 3))) > 1.0


def test_a_number_that_is_not_printed_is_noticed() -> None:
    assert agrees(["E  +1.000000e+00 J", "...", "z"], ["E  +1.000001e+00 J", "x", "y", "z"])
    assert not agrees(["E  +1.000000e+00 J"], ["E  +1.001000e+00 J"])
    assert not agrees(["E  1 J", "..."], ["F  1 J"])
    assert not agrees(["a"], ["a", "b"])
