"""An edit of a law compiles that law alone: kernels hold none, and a law is kept by what it computes."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import rthm_core
from rthm_core.addressed import Call
from rthm_core.law_code import key_of

PACKAGE = Path(rthm_core.__file__).parent
SPRING = "return -p[0] * x * x * x"

RUNS = """
import json, sys
from numba.core import event
from rthm_core.engine import simulate
from rthm_core.spec import apply, shipped_spec


class Compiled(event.Listener):
    names = []

    def on_start(self, found):
        self.names.append(found.data["dispatcher"].py_func.__qualname__)

    def on_end(self, found):
        pass


event.register("numba:compile", Compiled())
ONES = {"coulomb_friction": {"force": 0.1}, "cubic_stiffness": {"coefficient": 8.0}}


def last(kind):
    one = {"block": "plant", "dof": "x1", "kind": kind} | ONES[kind]
    spec = apply(shipped_spec("paper"), {"effects": ["one"], "one": one})
    return simulate(spec, 1.0, 0.1, energies=False).plant_position[-1, 0]


print(json.dumps([last(kind) for kind in ONES] + [Compiled.names]))
"""


def test_an_edit_of_a_law_compiles_no_kernel_and_no_other_law(tmp_path: Path) -> None:
    package = shutil.copytree(PACKAGE, tmp_path / "rthm_core", ignore=shutil.ignore_patterns("__pycache__"))
    environment = os.environ | {"RTHM_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": str(tmp_path)}

    def run() -> list[object]:
        command = [sys.executable, "-c", RUNS]
        done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True)
        found: list[object] = json.loads(done.stdout)
        return found

    friction, spring, compiled = run()
    assert "run_nonlinear" in compiled and "CubicStiffness.force" in compiled  # type: ignore[operator]
    assert run() == [friction, spring, []]
    stiffness = package / "effects" / "stiffness.py"
    text = stiffness.read_text()
    assert SPRING in text
    stiffness.write_text("# moves every line\n" + text.replace(SPRING, SPRING + " - 0.1 * p[0] * x"))
    friction_again, stiffer, compiled_again = run()
    assert friction_again == friction and stiffer != spring
    assert "CubicStiffness.force" in compiled_again  # type: ignore[operator]
    assert not {"run_nonlinear", "CoulombFriction.force"} & set(compiled_again)  # type: ignore[call-overload]


FORCE = Call("x, p", True)


def key(text: str, **outside: object) -> str | None:
    scope = dict(outside)
    exec(text, scope)
    return key_of(scope["force"], FORCE)  # type: ignore[arg-type]


def test_a_law_is_kept_by_what_it_computes_and_not_by_where_it_stands() -> None:
    law = "def force(x, p):\n    return -p[0] * x * steepness"
    assert key(law, steepness=2.0) == key("\n\n" + law, steepness=2.0, unused=1)
    assert key(law, steepness=2.0) != key(law, steepness=3.0)
    assert key(law, steepness=2.0) != key(law.replace("-p", "p"), steepness=2.0)


@pytest.mark.parametrize("outside", [[1.0, 2.0], object()])
def test_a_law_that_takes_what_has_no_name_is_not_kept(outside: object) -> None:
    assert key("def force(x, p):\n    return x * outside[0]", outside=outside) is None


def test_a_law_is_another_one_when_a_function_that_it_calls_is() -> None:
    law = "def force(x, p):\n    return inner(x)"
    one, two = (dict[str, object]() for _ in range(2))
    exec("def inner(x):\n    return x", one)
    exec("def inner(x):\n    return 2.0 * x", two)
    assert key(law, inner=one["inner"]) != key(law, inner=two["inner"])
