"""One definition per idea: what stands in one source file stands in no second one."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from rthm_bringup.cli.main import application
from rthm_bringup.run.roles import PROGRAMS
from rthm_core.compensators import COMPENSATORS, RESERVED
from rthm_core.effects.registry import declared
from rthm_core.topics import BESIDE, JOINT_STATE, LOOP, STRING, TIME_REFERENCE

SOURCES = Path(__file__).parents[1] / "src"

OTHERS = {
    "drift": {"recording/host_clocks.py", "cli/verbs/timing.py"},  # of a clock, s/s
    "scale": {"stability/analysis.py", "stability/result.py", "cli/verbs/stability.py"},  # of all delays
    "saturation": {"faults/clipped.py"},  # a fault of a recording
    "bias": {"tangents/changes.py"},  # an array of the engine
    "inertia": {"physical/laws.py"},  # a function of every law on the plant
}
"""Words that name a kind and mean something else in these files."""


TAYLOR_SYSTEM = "taylor"
"""Names the paper's linear error terms as well: a system that `simulate` and `response` know."""

FIGURE = "rthm_analysis/rthm_analysis/reproduce/prediction.py"
"""Draws these compensators beside each other: a text of its own."""


def sources() -> Iterator[tuple[str, ast.Module]]:
    """Every module that is no test, by its path."""
    for path in sorted(SOURCES.rglob("*.py")):
        if "test" not in path.relative_to(SOURCES).parts:
            yield path.as_posix(), ast.parse(path.read_text())


def texts(module: ast.Module) -> set[str]:
    """Texts of a module that are no docstrings."""
    docs = {id(node.value) for node in ast.walk(module) if isinstance(node, ast.Expr)}
    constants = (node for node in ast.walk(module) if isinstance(node, ast.Constant) and id(node) not in docs)
    return {node.value for node in constants if isinstance(node.value, str)}


ASSIGNED = re.compile(r"^([A-Z][A-Z_0-9]+)(?:: [^=]+)? = ([-+*/<() \d._e]*\d[-+*/<() \d._e]*)$", re.MULTILINE)
"""A name, and the number that it is given."""


def test_no_two_numbers_have_one_name() -> None:
    values: dict[str, set[str]] = {}
    for _, module in sources():
        for name, value in ASSIGNED.findall(ast.unparse(module)):
            values.setdefault(name, set()).add(value)
    assert len(values) > 300
    assert {name: told for name, told in values.items() if len(told) > 1} == {}


def test_the_name_and_equation_of_a_kind_stand_in_its_own_file_alone() -> None:
    homes: dict[str, set[str]] = {}
    for law in declared():
        if law.__module__.startswith("rthm_core."):
            for text in filter(None, (law.kind, law.equation)):
                homes.setdefault(text, set()).add(law.__module__.replace(".", "/") + ".py")
    assert len(homes) > 50
    found = [
        (path, text)
        for path, module in sources()
        for text in texts(module) & homes.keys()
        if not path.endswith(tuple(homes[text] | OTHERS.get(text, set())))
    ]
    assert not found


def test_the_name_of_a_compensator_stands_in_its_own_file_alone() -> None:
    names = {one.name for one in COMPENSATORS if one.predicts} - {TAYLOR_SYSTEM} | set(RESERVED)
    found = {path.partition("/src/")[2] for path, module in sources() if texts(module) & names}
    assert found - {FIGURE} == {"rthm_core/rthm_core/compensators.py"}


def test_the_name_of_a_topic_stands_in_its_own_file_alone() -> None:
    names = {topic for topic in LOOP | BESIDE if "/" in topic} | {JOINT_STATE, TIME_REFERENCE, STRING}
    found = {path.partition("/src/")[2] for path, module in sources() if texts(module) & names}
    assert found == {"rthm_core/rthm_core/topics.py"}


def test_a_verb_is_one_file_and_a_part_stands_in_two_besides_its_node() -> None:
    verbs = SOURCES / "rthm_bringup" / "rthm_bringup" / "cli" / "verbs"
    files = {path.stem.rstrip("_").replace("_", "-") for path in verbs.glob("*.py")} - {"--init"}
    commands = {command.name for command in application().registered_commands}
    assert commands == files
    nodes = set(PROGRAMS.values())
    found = {path.rpartition("/")[2] for path, module in sources() if texts(module) & nodes}
    assert found == {"roles.py"}
