"""Compile the kernels of this folder; the cache is keyed by their sources, too (see `rthm_core.compiled`)."""

from __future__ import annotations

from pathlib import Path

import numba

from rthm_core.compiled import keyed_by

inlined = numba.njit(inline="always", error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)
"""Compile as part of the callers."""

compiled = keyed_by(Path(__file__).parent, numba.njit(cache=True, nogil=True, error_model="numpy"))
"""Compile, without a lock on the interpreter: replays run side by side."""
