"""Compile the kernels of this folder; the cache is keyed by their sources, too (see `rthm_core.compiled`)."""

from __future__ import annotations

from pathlib import Path

from rthm_core.compiled import compiled as compiled_in_core
from rthm_core.compiled import compiled_in_place as compiled_in_place_in_core
from rthm_core.compiled import inlined, inlined_allocating, keyed_by

__all__ = ["compiled", "compiled_in_place", "inlined", "inlined_allocating"]

compiled = keyed_by(Path(__file__).parent, compiled_in_core)
"""Compile a pure function of numbers and arrays; the result is cached on disk."""

compiled_in_place = keyed_by(Path(__file__).parent, compiled_in_place_in_core)
"""The same for a function that makes no arrays."""
