"""Records of arrays that compiled functions hand to each other by one pointer, as C would.

A record is a NamedTuple. To hand it over itself is to hand over all that its arrays consist of, seven numbers
each: compiling a call then costs as much as a page of arithmetic.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel import models
from numba.core.imputils import lower_getattr_generic
from numba.core.types.containers import BaseNamedTuple
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import lower_builtin, register_model, type_callable


def lent(record: Any) -> Any:
    """A record to be handed on by its address, for as long as the function that lends it runs. Its fields are
    read as before, and records in it are lent, too.
    """
    return record


def given(record: Any) -> Any:
    """The record itself. A function that is not part of its callers lends it anew: nobody else can change it
    then, and what is used of it is kept in registers.
    """
    return record


class Lent(types.Type):
    """Type of a record that is lent."""

    def __init__(self, record: Any) -> None:
        self.record = record
        super().__init__(f"Lent({record})")

    def place(self, name: str) -> int:
        """Place of a field in the record."""
        return int(self.record.fields.index(name))


@register_model(Lent)
class _Address(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, ir.IntType(8).as_pointer())


def _typed_address(context: Any, builder: Any, kind: Any, address: Any) -> Any:
    return builder.bitcast(address, context.get_value_type(kind.record).as_pointer())


@type_callable(lent)  # type: ignore[untyped-decorator]
def _type_of_lent(context: Any) -> Any:
    return lambda record: record if isinstance(record, Lent) else Lent(record)


@lower_builtin(lent, BaseNamedTuple)  # type: ignore[untyped-decorator]
def _lend(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    place = cgutils.alloca_once_value(builder, arguments[0])
    return builder.bitcast(place, ir.IntType(8).as_pointer())


@type_callable(given)  # type: ignore[untyped-decorator]
def _type_of_given(context: Any) -> Any:
    return lambda record: record.record if isinstance(record, Lent) else record


@lower_builtin(given, Lent)  # type: ignore[untyped-decorator]
def _give(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return builder.load(_typed_address(context, builder, signature.args[0], arguments[0]))


@lower_builtin(given, BaseNamedTuple)  # type: ignore[untyped-decorator]
def _give_itself(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return arguments[0]


@infer_getattr
class _Fields(AttributeTemplate):  # type: ignore[misc]
    key = Lent

    def generic_resolve(self, kind: Any, name: str) -> Any:
        field = kind.record.types[kind.place(name)]
        return Lent(field) if isinstance(field, BaseNamedTuple) else field


@lower_getattr_generic(Lent)  # type: ignore[untyped-decorator]
def _field(context: Any, builder: Any, kind: Any, address: Any, name: str) -> Any:
    record = _typed_address(context, builder, kind, address)
    place = cgutils.gep_inbounds(builder, record, 0, kind.place(name))
    if isinstance(kind.record.types[kind.place(name)], BaseNamedTuple):
        return builder.bitcast(place, ir.IntType(8).as_pointer())
    return builder.load(place)
