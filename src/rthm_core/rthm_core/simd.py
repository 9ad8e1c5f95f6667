"""`WIDTH` numbers at once in compiled code: a kind of value with arithmetic in SIMD registers, whatever a
compiler makes of loops.

The numbers lie side by side along the last axis of an array, which is as long as the value is
wide. On a processor with shorter registers the compiler uses several of them.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel import models
from numba.core.errors import TypingError
from numba.extending import intrinsic, lower_builtin, register_model, type_callable

from rthm_core.compiled import Floats

WIDTH = 8
"""How many numbers."""

_NUMBERS = ir.VectorType(ir.DoubleType(), WIDTH)


def simd_empty(*shape: int) -> Floats:
    """Array without values, none of whose SIMD values will lie across two lines of the nearest memory: such a
    one takes twice as long to read.
    """
    size = math.prod(shape)
    memory = np.empty(size + WIDTH)
    begin = -(memory.__array_interface__["data"][0] // memory.itemsize) % WIDTH
    return memory[begin : begin + size].reshape(shape)


def simd_copy(values: Floats) -> Floats:
    """Copy of an array at such a place."""
    copy = simd_empty(*values.shape)
    copy[...] = values
    return copy


class Simd(types.Type):
    """Type of `WIDTH` numbers."""

    def __init__(self) -> None:
        super().__init__(f"Simd({WIDTH})")


simd = Simd()


@register_model(Simd)
class _Model(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _NUMBERS)


def _element(context: Any, builder: Any, signature: Any, arguments: Any, *further: int) -> Any:
    """Address of the number at an index, to which `further` ones are added."""
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    given = zip(cgutils.unpack_tuple(builder, arguments[1]), signature.args[1], strict=True)
    indices = [context.cast(builder, value, kind, types.intp) for value, kind in given]
    indices += [context.get_constant(types.intp, i) for i in further]
    return cgutils.get_item_pointer(
        context, builder, signature.args[0], array, indices, wraparound=False, boundscheck=False
    )


def _place(context: Any, builder: Any, signature: Any, arguments: Any, *further: int) -> Any:
    """Address of the numbers that begin at an index."""
    first = _element(context, builder, signature, arguments, *further, 0)
    return builder.bitcast(first, _NUMBERS.as_pointer())


def _check(array: Any, index: Any, axes: int = 1) -> None:
    if array.layout != "C" or array.dtype != types.float64 or array.ndim != len(index) + axes:
        raise TypingError(f"{array} holds no SIMD values at {index}: they lie side by side in memory.")


@intrinsic  # type: ignore[untyped-decorator]
def numbers(typing: Any, array: Any, index: Any) -> Any:
    """Numbers ``array[index]``, where `index` is a tuple of all axes but the last."""
    _check(array, index)

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.load(_place(context, builder, signature, arguments), align=8)

    return simd(array, index), code


@intrinsic  # type: ignore[untyped-decorator]
def put_numbers(typing: Any, array: Any, index: Any, value: Any) -> Any:
    """Let ``array[index]`` be `value`, where `index` is a tuple of all axes but the last."""
    _check(array, index)

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        builder.store(arguments[2], _place(context, builder, signature, arguments), align=8)
        return context.get_dummy_value()

    return types.none(array, index, value), code


def _place_from(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    """Address of the numbers that begin at a place of a flat array."""
    array = context.make_array(signature.args[0])(context, builder, arguments[0])
    return builder.bitcast(builder.gep(array.data, [arguments[1]]), _NUMBERS.as_pointer())


def _check_flat(row: Any) -> None:
    if row.layout != "C" or row.dtype != types.float64 or row.ndim != 1:
        raise TypingError(f"{row} is not a flat array of numbers.")


@intrinsic  # type: ignore[untyped-decorator]
def numbers_from(typing: Any, row: Any, begin: Any) -> Any:
    """Numbers ``row[begin : begin + WIDTH]`` of a flat array."""
    _check_flat(row)

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.load(_place_from(context, builder, signature, arguments), align=8)

    return simd(row, types.intp), code


@intrinsic  # type: ignore[untyped-decorator]
def put_numbers_from(typing: Any, row: Any, begin: Any, value: Any) -> Any:
    """Let ``row[begin : begin + WIDTH]`` of a flat array be `value`."""
    _check_flat(row)

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        builder.store(arguments[2], _place_from(context, builder, signature, arguments), align=8)
        return context.get_dummy_value()

    return types.none(row, types.intp, value), code


@intrinsic  # type: ignore[untyped-decorator]
def will_write(typing: Any, row: Any, begin: Any) -> Any:
    """Say that ``row[begin]`` of a flat array, which may be beyond its end, is written soon: its part of the
    memory is fetched meanwhile.
    """
    _check_flat(row)

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        place = builder.bitcast(builder.gep(array.data, [arguments[1]]), ir.IntType(8).as_pointer())
        kinds = [place.type, *[ir.IntType(32)] * 3]
        fetch = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(ir.VoidType(), kinds), "llvm.prefetch.p0"
        )
        builder.call(fetch, [place, *(ir.Constant(ir.IntType(32), i) for i in (1, 3, 1))])
        return context.get_dummy_value()

    return types.none(row, types.intp), code


@intrinsic  # type: ignore[untyped-decorator]
def put_first(typing: Any, array: Any, index: Any, value: Any, count: Any) -> Any:
    """Let so many numbers from ``array[index]`` on be the first of `value`, all where there are more."""
    _check(array, index, 0)

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        places = ir.VectorType(ir.IntType(64), WIDTH)
        ends = _spread(builder, arguments[3])
        mask = builder.icmp_signed("<", ir.Constant(places, list(range(WIDTH))), ends)
        kinds = [_NUMBERS, _NUMBERS.as_pointer(), ir.IntType(32), mask.type]
        store = cgutils.get_or_insert_function(
            builder.module,
            ir.FunctionType(ir.VoidType(), kinds),
            f"llvm.masked.store.v{WIDTH}f64.p0",
        )
        place = builder.bitcast(_element(context, builder, signature, arguments), _NUMBERS.as_pointer())
        builder.call(store, [arguments[2], place, ir.Constant(ir.IntType(32), 8), mask])
        return context.get_dummy_value()

    return types.none(array, index, value, types.intp), code


@intrinsic  # type: ignore[untyped-decorator]
def everywhere(typing: Any, number: Any) -> Any:
    """The same number `WIDTH` times."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _spread(builder, arguments[0])

    return simd(types.float64), code


@intrinsic  # type: ignore[untyped-decorator]
def element(typing: Any, array: Any, index: Any) -> Any:
    """One number ``array[index]``, where `index` is a tuple of all axes and does not count from the end: not
    to ask whether it does is what makes this faster.
    """

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.load(_element(context, builder, signature, arguments))

    return array.dtype(array, index), code


@intrinsic  # type: ignore[untyped-decorator]
def put_element(typing: Any, array: Any, index: Any, value: Any) -> Any:
    """Let one number ``array[index]`` be `value`, with an index as that of `element`."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        builder.store(arguments[2], _element(context, builder, signature, arguments))
        return context.get_dummy_value()

    return types.none(array, index, array.dtype), code


@intrinsic  # type: ignore[untyped-decorator]
def columns(typing: Any, array: Any, index: Any) -> Any:
    """Tuple of the columns of the block ``array[index]`` (WIDTH, WIDTH)."""
    _check(array, index, 2)
    several_of_them: Any = types.UniTuple(simd, WIDTH)  # type: ignore[attr-defined]

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        places = [_place(context, builder, signature, arguments, row) for row in range(WIDTH)]
        rows = [builder.load(place, align=8) for place in places]
        return context.make_tuple(builder, several_of_them, _turned(builder, rows))

    return several_of_them(array, index), code


def _turned(builder: Any, rows: list[Any]) -> list[Any]:
    """Columns of a block: rows a distance apart exchange what lies as far beside its diagonal."""
    kind, distance = ir.VectorType(ir.IntType(32), WIDTH), 1
    while distance < WIDTH:
        first = ir.Constant(kind, [i - distance + WIDTH if i & distance else i for i in range(WIDTH)])
        second = ir.Constant(kind, [i + WIDTH if i & distance else i + distance for i in range(WIDTH)])
        for i in range(WIDTH):
            if not i & distance:
                one, other = rows[i], rows[i + distance]
                rows[i] = builder.shuffle_vector(one, other, first)
                rows[i + distance] = builder.shuffle_vector(one, other, second)
        distance *= 2
    return rows


@intrinsic  # type: ignore[untyped-decorator]
def several(typing: Any, like: Any) -> Any:
    """Tuple of SIMD zeros, as long as `like`."""
    tuple_type: Any = types.UniTuple(simd, len(like))  # type: ignore[attr-defined]

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return context.make_tuple(builder, tuple_type, [ir.Constant(_NUMBERS, [0.0] * WIDTH)] * len(like))

    return tuple_type(like), code


def _spread(builder: Any, number: Any) -> Any:
    nothing = ir.Constant(ir.VectorType(number.type, WIDTH), ir.Undefined)
    first = builder.insert_element(nothing, number, ir.Constant(ir.IntType(32), 0))
    order = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)
    return builder.shuffle_vector(first, nothing, order)


def _arithmetic(operation: Callable[..., Any], instruction: str) -> None:
    """Let compiled code apply an operation to SIMD values, or to one and a number.

    A product and a sum may be rounded once, where the processor can do that.
    """

    @type_callable(operation)  # type: ignore[untyped-decorator]
    def _typed(context: Any) -> Any:
        def result(one: Any, other: Any) -> Any:
            pair = (one, other)
            if simd in pair and all(kind in (simd, types.float64) for kind in pair):
                return simd
            return None

        return result

    @lower_builtin(operation, simd, simd)  # type: ignore[untyped-decorator]
    @lower_builtin(operation, simd, types.float64)  # type: ignore[untyped-decorator]
    @lower_builtin(operation, types.float64, simd)  # type: ignore[untyped-decorator]
    def _code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        operands = [
            value if kind == simd else _spread(builder, value)
            for kind, value in zip(signature.args, arguments, strict=True)
        ]
        return getattr(builder, instruction)(*operands, flags=("contract",))


for _operation, _instruction in (
    (operator.add, "fadd"),
    (operator.iadd, "fadd"),
    (operator.sub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
):
    _arithmetic(_operation, _instruction)
