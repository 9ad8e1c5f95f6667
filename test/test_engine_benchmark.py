"""The yardsticks in C do the same work as the kernels that are measured by them."""

from __future__ import annotations

import numpy as np
import pytest
from benchmarks.engine.limit import NoCompilerError
from benchmarks.engine.twin import kernel_and_twin

from rthm_core.spec import shipped_spec


def test_the_twin_in_c_gives_the_rows_of_the_kernel() -> None:
    try:
        kernel, twin = kernel_and_twin(shipped_spec("paper"), 2.0, 0.0012)
    except NoCompilerError as reason:
        pytest.skip(str(reason))
    rows = kernel().plant
    assert np.abs(rows).max() > 0.1
    np.testing.assert_allclose(twin(), rows, rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(twin(), rows, rtol=0.0, atol=1e-13)  # a second call begins anew
