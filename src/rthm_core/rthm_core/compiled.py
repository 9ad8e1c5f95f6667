"""Compile physics written in Python, once per version of the sources."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any, TypeVar

import numba
import numpy as np
import numpy.typing as npt

from rthm_core.addressed import part
from rthm_core.compile_cache import SharedCache, cache_folder
from rthm_core.part_of_callers import PartOfCallers, Plain, PlainUnrolled

F = TypeVar("F", bound=Callable[..., Any])

Floats = npt.NDArray[np.float64]
"""Array of real numbers; shapes are in the docstrings."""

Integers = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]
"""Array of instants in ns, indices or codes."""


numba.config.CACHE_DIR = str(cache_folder())


def kept(function: F, compile_: Callable[[F], Any]) -> F:
    """A compiled function whose versions are kept on disk, each compiled by one process only."""
    dispatcher = compile_(function)
    dispatcher._cache = SharedCache(function)
    return dispatcher  # type: ignore[no-any-return]


def compiled(function: F) -> F:
    """Compile a pure function of numbers and arrays; the result is cached on disk.

    Division by zero gives inf or nan as in numpy, and floating-point order is kept, so that every process
    computes the same bits.
    """
    return kept(function, numba.njit(error_model="numpy", no_cfunc_wrapper=True))


@cache
def uncompiled(function: F) -> F:
    """The Python function behind a compiled one, which calls those behind the ones that it calls: what runs
    once is not worth the wait for its compilation.
    """
    plain = getattr(function, "py_func", function)
    used = {name: plain.__globals__[name] for name in plain.__code__.co_names if name in plain.__globals__}
    scope = plain.__globals__ | {
        name: uncompiled(one) for name, one in used.items() if hasattr(one, "py_func")
    }
    return FunctionType(plain.__code__, scope, plain.__name__, plain.__defaults__)  # type: ignore[return-value]


FUSED = {"contract"}
"""Flags with which a product and a sum may be rounded once, where the processor can do that."""


def fused(function: F) -> F:
    """As `compiled`, with products and sums `FUSED`; functions that it calls have flags of their own."""
    return kept(function, numba.njit(error_model="numpy", no_cfunc_wrapper=True, fastmath=FUSED))


_IN_PLACE: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True, "_nrt": False}


def compiled_in_place(function: F) -> F:
    """As `compiled`, for a function that changes what it is given and makes no arrays.

    References to arrays are then not counted, which for small systems costs more than all arithmetic.
    """
    return kept(function, numba.njit(**_IN_PLACE))


def fused_in_place(function: F) -> F:
    """As `fused`, for such a function."""
    return kept(function, numba.njit(**_IN_PLACE, fastmath=FUSED))


def plainly(function: F) -> F:
    """Have a compiled function optimised once and its loops left as they are (`Plain`): what goes through
    loops of a few turns is compiled sooner then, and runs no slower.
    """
    return _compiled_by(Plain, function)


def unrolled(function: F) -> F:
    """As `plainly`, for what holds states in tuples: loops over these are written out."""
    return _compiled_by(PlainUnrolled, function)


def _compiled_by(pipeline: type[Plain], function: F) -> F:
    compiler = getattr(function, "_compiler", None)  # numba may be switched off
    if compiler is not None:
        compiler.pipeline_class = pipeline
    return function


def keyed_by(folder: Path, compile_: Callable[[F], F]) -> Callable[[F], F]:
    """A way to compile functions outside this package: their cache is keyed by all sources of their folder
    as well.
    """
    digest = hashlib.sha256()
    for source in sorted(folder.glob("*.py")):
        digest.update(source.read_bytes())
    key = digest.hexdigest()[:16]

    def compiled_there(function: F) -> F:
        core = numba.config.CACHE_DIR
        numba.config.CACHE_DIR = str(Path(core) / key)
        try:
            return compile_(function)
        finally:
            numba.config.CACHE_DIR = core

    return compiled_there


_PART: dict[str, Any] = {
    "error_model": "numpy",
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
    "pipeline_class": PartOfCallers,
}
"""How a function is compiled that only compiled functions call: without a way in from Python."""


def inlined(function: Callable[..., Any]) -> Any:
    """Compile a function that only compiled functions call and that makes no arrays, as part of its callers.

    Left to itself the compiler calls all but the smallest; handing over the arrays of a small system then
    costs more than all arithmetic.
    """
    return part(function)


def written_out(function: Callable[..., Any]) -> Any:
    """As `inlined`, with its loops written out before it is linked: what a tuple holds then stays in
    registers, and in kernels whose own loops stay as they are (`plainly`) those over products are quicker.
    """
    return part(function, written_out=True)


def whole(function: Callable[..., Any]) -> Any:
    """As `inlined`, but called where it is called: what is long, or stands in several places, is optimised
    once. Records are `lent` to it.
    """
    return part(function, inline=False)


def called(function: Callable[..., Any]) -> Any:
    """Compile a function that only compiled functions call and that makes no arrays, and keep it on disk for
    all its callers: what is long and stands in several places takes minutes to compile otherwise.
    """
    return kept(function, numba.njit(_nrt=False, **_PART))


def inlined_allocating(function: Callable[..., Any]) -> Any:
    """As `inlined`, for a function that makes arrays."""
    return numba.njit(**_PART)(function)


@inlined
def copy_into(target, source):  # type: ignore[no-untyped-def]
    """Copy a vector; a plain loop compiles far faster than a slice."""
    for i in range(target.size):
        target[i] = source[i]
