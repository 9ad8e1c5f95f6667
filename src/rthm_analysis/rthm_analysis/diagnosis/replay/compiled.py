"""Compile the kernels of this folder; the cache is keyed by their sources, too (see `rthm_core.compiled`)."""

from __future__ import annotations

from pathlib import Path

import numba

from rthm_core.compiled import F, inlined, kept, keyed_by

__all__ = ["compiled", "inlined"]


def _compiled(function: F) -> F:
    return kept(function, numba.njit(nogil=True, error_model="numpy", no_cfunc_wrapper=True, _nrt=False))


compiled = keyed_by(Path(__file__).parent, _compiled)
"""Compile a function that makes no arrays, without a lock on the interpreter: replays run side by side."""
