from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from rthm_analysis.diagnosis.fitting.steps import moved
from rthm_analysis.diagnosis.fitting.sums import Sums


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_diverging_model_has_no_next_step_and_nothing_is_printed(
    bad: float, capfd: pytest.CaptureFixture[str]
) -> None:
    parameter = SimpleNamespace(value=1.0, scale=1.0, positive=False, along=None, low=-np.inf, high=np.inf)
    model = SimpleNamespace(values=np.ones(2), parameters=[parameter, parameter])
    sums = Sums(np.full((1, 2, 2), bad), np.ones((1, 2)), np.ones(1), np.zeros(2), np.zeros(2))
    with np.errstate(all="ignore"), pytest.raises(np.linalg.LinAlgError, match="diverging"):
        moved(model, sums, 1e-4)  # type: ignore[arg-type]
    assert capfd.readouterr().out == ""
