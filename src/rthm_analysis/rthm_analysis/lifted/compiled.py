"""Compile the kernels of this folder; the cache is keyed by their sources, too (see `rthm_core.compiled`)."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numba

from rthm_core.compiled import F, inlined, inlined_allocating
from rthm_core.compiled import compiled as compiled_in_core

__all__ = ["compiled", "inlined", "inlined_allocating"]


def _folder() -> str:
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return str(Path(numba.config.CACHE_DIR) / digest.hexdigest()[:16])


def compiled(function: F) -> F:
    """Compile a pure function of numbers and arrays; the result is cached on disk."""
    core = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = _folder()
    try:
        return compiled_in_core(function)
    finally:
        numba.config.CACHE_DIR = core
