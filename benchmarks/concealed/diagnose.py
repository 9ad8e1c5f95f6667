"""Ask for a diagnosis in a process that sees the bag, the nominal spec, and nothing else of the case."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import signal
import subprocess
import tempfile
import threading
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.concealed.case import Case

PASSED_ON = (
    "PATH",
    "HOME",
    "LANG",
    "LC_ALL",
    "TMPDIR",
    "VIRTUAL_ENV",
    "PYTHONPATH",
    "LD_LIBRARY_PATH",
    "NUMBA_CACHE_DIR",
    "OPENBLAS_NUM_THREADS",
)
LONGEST = 600.0  # s


class DiagnosisError(Exception):
    """The diagnosis gave no result; the message says what it said."""


class Done(NamedTuple):
    """What a program printed, and the CPU time that it took, s."""

    out: str
    err: str
    cpu: float


def diagnose(command: str, case: Case, **more: str) -> dict[str, Any]:
    """Run a command and return the JSON that it prints, with its CPU time in s as ``cpu``.

    Parameters
    ----------
    command
        With ``{bag}`` and ``{spec}``, and the names in `more`, in braces.
    case
        Its bag and nominal spec are copied to a fresh folder under neutral names.

    Raises
    ------
    DiagnosisError
        When the command prints no JSON, or takes longer than `LONGEST`.
    """
    with tempfile.TemporaryDirectory(prefix="recording-") as folder:
        bag = shutil.copytree(case.bag, Path(folder) / "bag")
        spec = shutil.copy(case.spec, Path(folder) / "spec.yaml")
        words = [w.format(bag=bag, spec=spec, **more) for w in shlex.split(command)]
        try:
            done = _run(words, folder)
        except OSError as error:
            raise DiagnosisError(str(error)) from None
        try:
            return json.loads(done.out) | {"cpu": done.cpu}
        except json.JSONDecodeError:
            said = done.err.strip().splitlines()[-1:]
            raise DiagnosisError(" ".join(said) or "no JSON on standard output") from None


def _run(words: list[str], folder: str) -> Done:
    """Run a program in a folder; others that run beside it do not count for its CPU time."""
    environment = {k: os.environ[k] for k in PASSED_ON if k in os.environ}
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        program = subprocess.Popen(words, cwd=folder, env=environment, stdout=out, stderr=err)
        late = threading.Timer(LONGEST, program.kill)
        late.start()
        _, status, used = os.wait4(program.pid, 0)
        late.cancel()
        program.returncode = os.waitstatus_to_exitcode(status)
        if program.returncode == -signal.SIGKILL:
            raise DiagnosisError(f"no answer within {LONGEST:.0f} s")
        out.seek(0)
        err.seek(0)
        return Done(out.read(), err.read(), used.ru_utime + used.ru_stime)
