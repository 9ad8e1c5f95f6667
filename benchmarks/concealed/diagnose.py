"""Ask for a diagnosis in a process that sees the bag, the nominal spec, and nothing else of the case."""

from __future__ import annotations

import json
import os
import shlex
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

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


def diagnose(command: str, case: Case, **more: str) -> dict[str, Any]:
    """Run a command and return the JSON that it prints.

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
        environment = {k: os.environ[k] for k in PASSED_ON if k in os.environ}
        try:
            done = subprocess.run(
                words,
                cwd=folder,
                env=environment,
                capture_output=True,
                text=True,
                timeout=LONGEST,
                check=False,
            )
            return json.loads(done.stdout)
        except subprocess.TimeoutExpired:
            raise DiagnosisError(f"no answer within {LONGEST:.0f} s") from None
        except (OSError, json.JSONDecodeError) as error:
            said = (
                done.stderr.strip().splitlines()[-1:]
                if isinstance(error, json.JSONDecodeError)
                else [str(error)]
            )
            raise DiagnosisError(" ".join(said) or "no JSON on standard output") from None
