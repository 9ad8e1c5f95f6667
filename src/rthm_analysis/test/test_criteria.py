"""Every number that decides something in the diagnosis has one name, one place and a reason."""

from __future__ import annotations

import ast
import importlib
import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

import rthm_analysis.diagnosis

DIAGNOSIS = Path(rthm_analysis.diagnosis.__file__).parent
CRITERIA = DIAGNOSIS / "criteria"
PAGES = sorted(path for path in CRITERIA.glob("*.py") if path.stem != "__init__")

ELSEWHERE = {
    "computed/structure.py": {"LOAD_COEFFICIENTS"},  # a shape of arrays
    "experiment/closed.py": {"FILTERS_PER_ACTUATOR"},  # a shape of arrays
    "faults/unit_ratios.py": {"_LENGTHS", "RATIOS"},  # units
    "links/ages.py": {"GOLDEN"},  # the golden ratio
    "links/fitting.py": {"INFINITE_GRAINS"},  # an infinity of integers
    "replay/motor.py": {"POLES_APART", "POLES_NEAR"},  # arithmetic
    # compiled, and compiled anew only where its own folder changes
    "replay/kernel.py": {"SWITCHES_OF_AN_INTERVAL"},
    "replay/steps.py": {"MOST_TRIALS"},
}
"""Numbers that bound nothing of a recording, by module."""


def test_numbers_outside_the_criteria_decide_nothing() -> None:
    found = defaultdict(set)
    for path in _modules():
        if path.parent != CRITERIA:
            module = importlib.import_module(_dotted(path))
            numbers = {name for name in _names(path) if _is_number(getattr(module, name))}
            found[path.relative_to(DIAGNOSIS).as_posix()] |= numbers
    assert {where: names for where, names in found.items() if names} == ELSEWHERE


def test_no_name_has_two_places() -> None:
    places = defaultdict(list)
    for path in _modules():
        for name in _names(path):
            places[name].append(path.relative_to(DIAGNOSIS).as_posix())
    assert {name: where for name, where in places.items() if len(where) > 1} == {}


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
def test_a_criterion_says_what_it_bounds_and_is_used(path: Path) -> None:
    constants = set(_names(path))
    assert constants - _explained(path) == set()
    users = {name for module in _modules() for name in _imported(module, _dotted(path))}
    assert constants - users == set()


def test_the_page_of_contents_names_all_pages() -> None:
    text = ast.get_docstring(ast.parse((CRITERIA / "__init__.py").read_text())) or ""
    assert set(re.findall(r"^``(\w+)``", text, re.MULTILINE)) == {path.stem for path in PAGES}


def _modules() -> list[Path]:
    return sorted(DIAGNOSIS.rglob("*.py"))


def _dotted(path: Path) -> str:
    parts = path.relative_to(DIAGNOSIS).with_suffix("").parts
    return ".".join(("rthm_analysis", "diagnosis", *(part for part in parts if part != "__init__")))


def _assigned(node: ast.stmt) -> Iterator[str]:
    """Constants that a statement assigns."""
    targets: list[ast.expr] = []
    if isinstance(node, ast.Assign):
        targets = node.targets
    elif isinstance(node, ast.AnnAssign):
        targets = [node.target]
    for target in targets:
        for one in ast.walk(target):
            if isinstance(one, ast.Name) and re.fullmatch(r"_?[A-Z][A-Z0-9_]*", one.id):
                yield one.id


def _names(path: Path) -> list[str]:
    return [name for node in ast.parse(path.read_text()).body for name in _assigned(node)]


def _explained(path: Path) -> set[str]:
    """Constants with a docstring below them, or below the lines that follow without a gap."""
    found, group, end = set(), set(), 0
    for node in ast.parse(path.read_text()).body:
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            found |= group if node.lineno == end + 1 else set()
        elif node.lineno > end + 1:
            group = set()
        group |= set(_assigned(node))
        end = node.end_lineno or 0
    return found


def _imported(path: Path, module: str) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module == module:
            yield from (one.name for one in node.names)


def _is_number(value: object) -> bool:
    if isinstance(value, (tuple, list)):
        return len(value) > 0 and all(map(_is_number, value))
    if isinstance(value, dict):
        return len(value) > 0 and all(map(_is_number, value.values()))
    return isinstance(value, (int, float)) and not isinstance(value, bool)
