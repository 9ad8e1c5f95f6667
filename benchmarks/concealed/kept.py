"""Compiled code of the generator, kept on disk: an edit of any of its files compiles all of it anew."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba

HERE = Path(__file__).parent


def kept(function: Callable[..., Any]) -> Any:
    """Compile a function that calls others; where it may be kept, it is compiled by one process only."""
    sources = b"".join(file.read_bytes() for file in sorted(HERE.glob("*.py")))
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(HERE / "__pycache__" / hashlib.sha256(sources).hexdigest()[:16])
    try:
        return numba.njit(nogil=True, cache=True)(function)
    except RuntimeError:  # nobody may write there
        return numba.njit(nogil=True)(function)
    finally:
        numba.config.CACHE_DIR = before
