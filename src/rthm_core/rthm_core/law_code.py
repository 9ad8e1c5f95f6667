"""Machine code of one function of a law, compiled once for all processes and kept on disk.

The key is what the function is: its own instructions and those of all that it calls, and the numbers that
they take from outside. So an edit of one law compiles that law alone, and nothing else is ever made again.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any, NamedTuple

import numba
from numba import types
from numba.core.registry import cpu_target
from numba.core.runtime import rtsys

from rthm_core.addressed import ARRAYS, MOST_NUMBERS, WHOLE, Call, part
from rthm_core.compile_cache import private_folder

FOLDER = "laws"
"""Beside the folders of the kernels, which are named by the sources of the package."""

_folder = cache(private_folder)

_HERE = b"".join((Path(__file__).parent / f"{name}.py").read_bytes() for name in ("addressed", "law_code"))
"""How a law is compiled and called."""


class LawCode(NamedTuple):
    """A function in memory: its address, and the library that must live as long."""

    address: int
    library: Any


@cache
def law_code(function: Callable[..., Any], how: Call) -> LawCode:
    """A function of a law as C would call it; what returns nothing returns zero.

    Raises
    ------
    NumbaError
        If it cannot be compiled.
    """
    key = key_of(function, how)
    file = None if key is None else _folder(FOLDER) / f"{key}.law"
    found = None if file is None else _read(file)
    return found or _made(function, how, file)


def _read(file: Path) -> LawCode | None:
    """What is kept in a file; None where there is none, or half a one."""
    try:
        name, data = pickle.loads(file.read_bytes())
    except (OSError, EOFError, ValueError, pickle.UnpicklingError):
        return None
    context = cpu_target.target_context
    rtsys.initialize(context)
    library = context.codegen().unserialize_library(data)
    return LawCode(library.get_pointer_to_function(name), library)


def _made(function: Callable[..., Any], how: Call, file: Path | None) -> LawCode:
    """Compile a function, and keep it in a file."""
    scope = {"carray": numba.carray, "function": part(function, nrt=True)}
    seen = (f"carray({one}, ({MOST_NUMBERS},))" if one in ARRAYS else one for one in how.names)
    call = f"function({', '.join(seen)})"
    lines = [f"    return {call}"] if how.returns else [f"    {call}", "    return 0.0"]
    exec("\n".join([f"def entry({how.arguments}):", *lines]), scope)
    made = numba.cfunc(types.float64(*map(_type, how.names)), error_model="numpy", forceinline=True)(
        scope["entry"]
    )
    library, name = made._library, made.native_name
    if file is not None:
        fresh = file.with_suffix(f".{os.getpid()}")
        fresh.write_bytes(pickle.dumps((name, library.serialize_using_object_code())))
        fresh.replace(file)
    return LawCode(made.address, library)


def _type(name: str) -> Any:
    if name in ARRAYS:
        return types.CPointer(types.float64)
    return types.int64 if name in WHOLE else types.float64


def key_of(function: Callable[..., Any], how: Call) -> str | None:
    """Name under which a function is kept; None where it takes something from outside that has no name."""
    parts = [_HERE, repr((how, numba.__version__, sys.version, _processor())).encode()]
    try:
        parts += _parts(function, set())
    except TypeError:
        return None
    return hashlib.sha256(b"\0".join(parts)).hexdigest()[:32]


def _processor() -> Any:
    return cpu_target.target_context.codegen().magic_tuple()


def _parts(function: Any, done: set[Any]) -> Iterator[bytes]:
    """All that a function computes with.

    Raises
    ------
    TypeError
        If it takes something from outside that is no number, function or module of mathematics.
    """
    options = repr(sorted(getattr(function, "targetoptions", {}).items()))
    function = getattr(function, "py_func", function)
    if function in done:
        return
    done.add(function)
    yield options.encode()
    yield from _instructions(function.__code__)
    inside = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    known = function.__globals__ | {name: cell.cell_contents for name, cell in inside}
    for name in sorted(_names(function.__code__)):
        if name in known:
            yield name.encode()
            yield from _outside(known[name], done)


def _outside(value: Any, done: set[Any]) -> Iterator[bytes]:
    if hasattr(value, "py_func") or hasattr(value, "__code__"):
        yield from _parts(value, done)
    elif isinstance(value, ModuleType) and value.__name__ in ("math", "numpy"):
        yield value.__name__.encode()
    elif isinstance(value, bool | int | float):
        yield repr(value).encode()
    else:
        raise TypeError


def _instructions(code: CodeType) -> Iterator[bytes]:
    """Of a function, without the place where it is written."""
    yield code.co_code
    yield repr((code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars)).encode()
    for value in code.co_consts:
        if isinstance(value, CodeType):
            yield from _instructions(value)
        else:
            yield repr(value).encode()


def _names(code: CodeType) -> set[str]:
    """Names that a function looks up outside itself."""
    inner = (value for value in code.co_consts if isinstance(value, CodeType))
    return {*code.co_names, *code.co_freevars}.union(*map(_names, inner))
