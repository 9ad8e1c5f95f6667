"""Call compiled functions that were not there when their caller was compiled, by their address.

Compiled code is kept on disk, and making it again takes seconds. So what a user adds is no part of it: each
of his functions is compiled by itself, and a table of their addresses is handed to the kernels as a number,
in the place of the code of a law that they know.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic


class Call(NamedTuple):
    """How a function is called: its arguments, as ``"x, v, z, t, p, mode"``, and whether it returns a
    number; else it returns nothing.
    """

    arguments: str
    returns: bool

    @property
    def names(self) -> list[str]:
        """Arguments one by one."""
        return self.arguments.split(", ")


ARRAYS, WHOLE = frozenset({"z", "p", "dz"}), frozenset({"mode"})
"""Arguments of laws that are arrays, and those that are whole numbers; all others are real."""

FIRST_ADDRESS = 1 << 16
"""No table is at a smaller address, and no code of a law is larger."""

MOST_NUMBERS = 16
"""Length of an array as an added function sees it; its caller's may be shorter, and what is beyond is not
its own.
"""

_TABLES: dict[int, Any] = {}
"""By address: the table, and the functions in it, which must outlive every kernel that may call them."""


def table_of(functions: Sequence[tuple[Callable[..., Any], Call]]) -> int:
    """Address of a table of functions, which are compiled here."""
    made = [_entry(function, how) for function, how in functions]
    table = np.array([one.address for one in made], dtype=np.int64)
    address = int(table.ctypes.data)
    _TABLES[address] = (table, made)
    return address


@cache
def _entry(function: Callable[..., Any], how: Call) -> Any:
    """One compiled function as C would call it; what returns nothing returns zero."""
    seen = (f"carray({one}, ({MOST_NUMBERS},))" if one in ARRAYS else one for one in how.names)
    scope = {"carray": numba.carray, "function": numba.njit(error_model="numpy")(function)}
    call = f"function({', '.join(seen)})"
    lines = [f"    return {call}"] if how.returns else [f"    {call}", "    return 0.0"]
    exec("\n".join([f"def entry({how.arguments}):", *lines]), scope)
    return numba.cfunc(types.float64(*map(_type, how.names)))(scope["entry"])


def _type(name: str) -> Any:
    if name in ARRAYS:
        return types.CPointer(types.float64)
    return types.int64 if name in WHOLE else types.float64


def caller(slot: int, how: Call) -> Any:
    """Function ``call(table, <arguments>)`` for compiled code: what stands in a `slot` of a table."""

    def declared(*given: Any) -> tuple[Any, Callable[..., Any]]:
        def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            table, *rest = values
            passed = [
                _passed(context, builder, name, of, value)
                for name, of, value in zip(how.names, signature.args[1:], rest, strict=True)
            ]
            kind = ir.FunctionType(ir.DoubleType(), [one.type for one in passed])
            place = builder.add(table, ir.Constant(table.type, 8 * slot))
            function = builder.load(builder.inttoptr(place, kind.as_pointer().as_pointer()))
            found = builder.call(function, passed)
            return found if how.returns else context.get_dummy_value()

        return (types.float64 if how.returns else types.none)(types.int64, *given), code

    scope: dict[str, Any] = {"declared": declared}
    exec(f"def call(typingcontext, table, {how.arguments}):\n    return declared({how.arguments})", scope)
    return intrinsic(scope["call"])


def _passed(context: Any, builder: Any, name: str, of: Any, value: Any) -> Any:
    """An argument as C passes it; of an array, where it begins."""
    if name in ARRAYS:
        return context.make_array(of)(context, builder, value).data
    return context.cast(builder, value, of, types.int64 if name in WHOLE else types.float64)
