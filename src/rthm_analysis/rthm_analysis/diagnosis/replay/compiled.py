"""Compile the kernels of this folder; the cache is keyed by their sources, too (see `rthm_core.compiled`)."""

from __future__ import annotations

from pathlib import Path

import numba

from rthm_core.compiled import inlined, keyed_by

__all__ = ["compiled", "inlined"]

compiled = keyed_by(
    Path(__file__).parent,
    numba.njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True, _nrt=False),
)
"""Compile a function that makes no arrays, without a lock on the interpreter: replays run side by side."""
