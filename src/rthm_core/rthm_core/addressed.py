"""Call compiled functions that were not there when their caller was compiled, by their address.

Kernels are kept on disk, and making one again takes seconds. So no law is part of them, be it of this package
or of a user: each of its functions is compiled by itself (`law_code`), and a table of their addresses is
handed to the kernels as a number, the code of the law. Addresses differ from process to process; they are
data, and never part of what is kept.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from rthm_core.part_of_callers import PartOfCallers, WrittenOutPart


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

MOST_NUMBERS = 16
"""Length of an array as an addressed function sees it; its caller's may be shorter, and what is beyond is not
its own.
"""

PURE = ("nounwind", "readonly")
"""What the compiler may know of functions that return a number: they change nothing."""

NOT_THERE = 0
"""Stands in the slot of a function that a law leaves as it is."""

_TABLES: dict[int, Any] = {}
"""By address: the table, and the functions in it, which must outlive every kernel that may call them."""


def table_of(functions: Sequence[tuple[Callable[..., Any] | None, Call]]) -> int:
    """Address of a table of functions, which are compiled here or read from the disk; None: not there."""
    from rthm_core.law_code import law_code

    made = [None if function is None else law_code(function, how) for function, how in functions]
    table = np.array([NOT_THERE if one is None else one.address for one in made], dtype=np.int64)
    address = int(table.ctypes.data)
    _TABLES[address] = (table, made)
    return address


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
            function = builder.load(_slot(builder, table, slot, kind.as_pointer()))
            found = builder.call(function, passed, attrs=PURE if how.returns else ())
            return found if how.returns else context.get_dummy_value()

        return (types.float64 if how.returns else types.none)(types.int64, *given), code

    scope: dict[str, Any] = {"declared": declared}
    exec(f"def call(typingcontext, table, {how.arguments}):\n    return declared({how.arguments})", scope)
    return intrinsic(scope["call"])


def _slot(builder: Any, table: Any, slot: int, kind: Any) -> Any:
    """Where a slot of a table is, which holds something of a kind."""
    return builder.inttoptr(builder.add(table, ir.Constant(table.type, 8 * slot)), kind.as_pointer())


def _there(slot: int) -> Any:
    """Function ``there(table)`` for compiled code: whether something stands in a `slot`."""

    def there(typingcontext: Any, table: Any) -> tuple[Any, Callable[..., Any]]:
        def code(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            found = builder.load(_slot(builder, values[0], slot, values[0].type))
            return builder.icmp_unsigned("!=", found, ir.Constant(found.type, NOT_THERE))

        return types.boolean(types.int64), code

    return intrinsic(there)


def law_function(calls: dict[str, Call], name: str, otherwise: Callable[..., Any] | None = None) -> Any:
    """Function ``f(code, <arguments>)`` for compiled code: that of this name of the law with a code.

    Parameters
    ----------
    calls
        Functions of a law, in the order of the slots of its table.
    name
    otherwise
        What is done for laws that leave it as it is; None: each has its own.
    """
    slot, how = list(calls).index(name), calls[name]
    scope: dict[str, Any] = {"call": caller(slot, how), "there": _there(slot)}
    lines = [f"def {name}(code, {how.arguments}):", f"    return call(code, {how.arguments})"]
    if otherwise is not None:
        scope["otherwise"] = part(otherwise)
        lines[1:1] = ["    if not there(code):", f"        return otherwise({how.arguments})"]
    exec("\n".join(lines), scope)
    return part(scope[name])


def part(
    function: Callable[..., Any], *, nrt: bool = False, inline: bool = True, written_out: bool = False
) -> Any:
    """A function that is compiled as part of its callers; `nrt`: it may make arrays; `inline`: it is
    called nowhere, but stands there itself; `written_out`: so do the turns of its loops.
    """
    return numba.njit(
        _nrt=nrt,
        forceinline=inline,
        error_model="numpy",
        no_cpython_wrapper=True,
        no_cfunc_wrapper=True,
        pipeline_class=WrittenOutPart if written_out else PartOfCallers,
    )(function)


def _passed(context: Any, builder: Any, name: str, of: Any, value: Any) -> Any:
    """An argument as C passes it; of an array, where it begins."""
    if name in ARRAYS:
        return context.make_array(of)(context, builder, value).data
    return context.cast(builder, value, of, types.int64 if name in WHOLE else types.float64)
