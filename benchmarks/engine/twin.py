"""Our kernel of linear loops beside the same work in C, on prepared matrices and rows."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.engine.limit import build

from rthm_core.clock import to_ns
from rthm_core.compiled import Floats
from rthm_core.engine.linear.blocks import Rows
from rthm_core.engine.linear.preparation import Prepared, Start
from rthm_core.engine.linear.run import kernel_call, prepared_loop
from rthm_core.schedule import MOTOR, OUTPUT, REFERENCE, SAMPLE
from rthm_core.spec import Spec

SOURCE = Path(__file__).with_name("linear_twin.c")


def kernel_and_twin(
    spec: Spec, duration: float, sample: float
) -> tuple[Callable[[], Rows], Callable[[], Floats]]:
    """Calls of our kernel and of its twin in C; the former gives all rows, the latter those of the plant."""
    end, step = to_ns(duration), to_ns(sample)
    ours, prepared = kernel_call(spec, end, step), prepared_loop(spec, step)
    if ours is None or prepared is None:
        raise ValueError("nothing repeats in this loop")
    return ours, _twin(*prepared, end // prepared[0].operations.period + 1, end // step + 1)


def _plain(matrices: Floats, outputs: int) -> Floats:
    """Matrices (K, ., outputs), which in our kernel may be in blocks of outputs."""
    return matrices.reshape(*matrices.shape[:2], -1)[:, :, :outputs]


def _twin(one: Prepared, start: Start, passes: int, count: int) -> Callable[[], Floats]:
    tables, operations = one.tables, one.operations
    width, numerical_width, m = (len(row) for row in start.widths)
    n1, n2 = len(start.state[0]), len(start.state[2])
    out = [np.empty((count, columns)) for columns in (width, numerical_width, m)]
    fresh = [*start.memory[:2], *(np.array(part) for part in start.state[:4])]
    work = [array.copy() for array in fresh]
    sizes = [operations.what.size, passes, count, MOTOR, REFERENCE, SAMPLE, OUTPUT]
    sizes += [len(memory) - 1 for memory in fresh[:2]]
    given: list[Any] = [operations.what, operations.plant, operations.numerical]
    given += [operations.sample, operations.reference]
    rows = (tables.plant, tables.numerical, tables.sample, tables.plant_row, tables.numerical_row)
    columns = zip((*rows, tables.reference), (n1, n2, 2 * m, width, numerical_width, m), strict=True)
    given += [_plain(matrices, outputs) for matrices, outputs in columns]
    given += [tables.bias, tables.k_tot, *work, *out]
    kept = [np.ascontiguousarray(array) for array in given]
    packed = np.array([*sizes, *(array.ctypes.data for array in kept)], dtype=np.int64)
    function = build(
        SOURCE,
        N1=n1,
        N2=n2,
        M=m,
        WIDTH1=width,
        WIDTH2=numerical_width,
    ).run
    function.argtypes = [ctypes.c_void_p]

    def call() -> Floats:
        for array, first in zip(work, fresh, strict=True):
            array[...] = first
        function(packed.ctypes.data)
        return np.asarray(kept[-3])

    return call
