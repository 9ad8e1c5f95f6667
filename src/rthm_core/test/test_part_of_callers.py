"""What never runs by itself is optimised in its callers alone, and read from the disk by others of them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

PROGRAM = """
import sys

from rthm_core.compiled import called, compiled, inlined


@inlined
def half(number):
    return 0.5 * number


@called
def power(number, times):
    result = 1.0
    for _ in range(times):
        result *= number
    return half(result)


@compiled
def first(number):
    return power(number, 3)


@compiled
def second(number):
    return 2.0 * power(number, 3)


assert {"first": first, "second": second}[sys.argv[1]](2.0) == {"first": 4.0, "second": 8.0}[sys.argv[1]]
for part in (half, power):
    for one in part.overloads.values():
        assert one.library.get_pointer_to_function(one.fndesc.llvm_func_name) == 0
print(sum(power.stats.cache_misses.values()), sum(power.stats.cache_hits.values()), len(half.overloads))
"""


def test_a_part_has_no_machine_code_of_its_own_and_is_kept_for_its_callers(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    environment = os.environ | {"RTHM_CACHE_DIR": str(tmp_path / "cache")}

    def said(caller: str) -> list[str]:
        command = [sys.executable, str(program), caller]
        done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True)
        return done.stdout.split()

    assert said("first") == ["1", "0", "1"]
    assert said("second") == ["0", "1", "0"]
    assert said("second") == ["0", "0", "0"]
