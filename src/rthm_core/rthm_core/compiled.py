"""Compile physics written in Python, once per version of the sources.

Numba's own cache looks at one file only: a cached caller can keep an old callee of another module. The cache folder is therefore keyed by a
hash of all sources of this package.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba
import numpy as np
import numpy.typing as npt

F = TypeVar("F", bound=Callable[..., Any])

Floats = npt.NDArray[np.float64]
"""Array of real numbers; shapes are in the docstrings."""

Integers = npt.NDArray[np.int64]
"""Array of instants in ns, indices or codes."""


def _source_hash() -> str:
    digest = hashlib.sha256(numba.__version__.encode())
    package = Path(__file__).parent
    for source in sorted(package.rglob("*.py")):
        digest.update(str(source.relative_to(package)).encode())
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def _cache_folder() -> Path:
    """Where compiled code is kept: ``RTHM_CACHE_DIR``, the user's cache, or a temporary folder when neither can be written."""
    base = os.environ.get("RTHM_CACHE_DIR") or os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    folder = Path(base) / "rthm" / "compiled" / _source_hash()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if os.access(folder, os.W_OK):
            return folder
    except OSError:
        pass
    return Path(tempfile.gettempdir()) / f"rthm-compiled-{os.getuid()}" / _source_hash()


numba.config.CACHE_DIR = str(_cache_folder())


def compiled(function: F) -> F:
    """Compile a pure function of numbers and arrays; the result is cached on disk.

    Division by zero gives inf or nan as in numpy, and floating-point order is kept, so that every process computes the same bits.
    """
    return numba.njit(cache=True, error_model="numpy")(function)  # type: ignore[no-any-return]


def inlined(function: F) -> F:
    """Compile a small function that only compiled functions call; it is part of its callers' cache."""
    return numba.njit(error_model="numpy")(function)  # type: ignore[no-any-return]


def chained(functions: list[Callable[..., Any]], otherwise: Callable[..., Any]) -> Callable[..., Any]:
    """One compiled function ``f(code, *args)`` that calls ``functions[code]``.

    Compiled code cannot look a Python object up; the chain makes a list of laws callable by number without a second list of names.
    """
    rest = inlined(otherwise)
    for code in range(len(functions) - 1, -1, -1):
        rest = _choose(code, inlined(functions[code]), rest, first=code == len(functions) - 1)
    return rest


def _choose(code: int, head: Callable[..., Any], rest: Callable[..., Any], *, first: bool) -> Callable[..., Any]:
    if first:

        def choice(number, *args):  # type: ignore[no-untyped-def]
            if number == code:
                return head(*args)
            return rest(*args)
    else:

        def choice(number, *args):  # type: ignore[no-untyped-def]
            if number == code:
                return head(*args)
            return rest(number, *args)

    return inlined(choice)
