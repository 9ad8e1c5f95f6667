"""What one process compiles, the others read."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

COMPILES = '''
"""Compiles one function; said of each step are files in the folder of the argument."""

import sys, time
from pathlib import Path

from numba.core import event

from rthm_core.compiled import compiled

folder, own, other = Path(sys.argv[1]), *sys.argv[2:]


class Compiling(event.Listener):
    def on_start(self, _):
        (folder / f"{own} compiles").touch()
        while not (folder / f"{other} begins").exists():
            time.sleep(0.01)
        time.sleep(0.5)

    def on_end(self, _):
        pass


@compiled
def twice(number):
    return 2.0 * number


event.register("numba:compile", Compiling())
(folder / f"{own} begins").touch()
assert twice(3.0) == 6.0
print(sum(twice.stats.cache_misses.values()), sum(twice.stats.cache_hits.values()))
'''


def test_a_process_waits_for_another_that_compiles_the_same_and_reads_what_it_made(tmp_path: Path) -> None:
    program = tmp_path / "compiles.py"
    program.write_text(COMPILES)
    environment = os.environ | {"RTHM_CACHE_DIR": str(tmp_path / "cache")}

    def start(own: str, other: str) -> subprocess.Popen[str]:
        command = [sys.executable, str(program), str(tmp_path), own, other]
        return subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)

    processes = start("one", "two"), start("two", "one")
    said = sorted(process.communicate(timeout=60.0)[0].split() for process in processes)
    assert said == [["0", "1"], ["1", "0"]]
    assert len(list(tmp_path.glob("* compiles"))) == 1


READS = '''
"""Calls a function that changes an array, and one that makes an array; says what was made ready for each."""

import numpy as np
from numba.core.runtime import rtsys

from rthm_core.compiled import compiled, compiled_in_place


@compiled_in_place
def double(numbers):
    for i in range(numbers.size):
        numbers[i] *= 2.0


@compiled
def ones(count):
    made = np.empty(count)
    for i in range(count):
        made[i] = 1.0
    return made


numbers = np.ones(3)
double(numbers)
counted = rtsys._init
print(counted, rtsys._init if ones(3).sum() == 3.0 == numbers.sum() / 2 else "wrong")
'''


def test_code_from_the_disk_is_made_ready_to_count_references_where_it_counts_any(tmp_path: Path) -> None:
    program = tmp_path / "reads.py"
    program.write_text(READS)
    environment = os.environ | {"RTHM_CACHE_DIR": str(tmp_path / "cache")}
    command = [sys.executable, str(program)]
    said = [subprocess.check_output(command, env=environment, text=True).split() for _ in range(2)]
    assert said == [["True", "True"], ["False", "True"]]
