"""A model that diverges on unseen data is the worst of all, never a perfect one."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import DIVERGED_ERROR
from rthm_analysis.diagnosis.physical.judged import held_out_squares, nrmse
from rthm_analysis.diagnosis.physical.side import Physical


def _recorded() -> Physical:
    measured = np.sin(np.arange(300.0))[:, None]
    measured[250] = np.nan
    found = SimpleNamespace(
        evidence=SimpleNamespace(measured=measured),
        noise=SimpleNamespace(sigma=np.ones(1), level=np.full(1, 1e-3), colours=()),
        windows=SimpleNamespace(start=np.zeros(1, int)),
        train=200,
    )
    return cast("Physical", found)


def test_what_is_not_simulated_to_the_end_counts_as_the_largest_error() -> None:
    physical = _recorded()
    wrong = np.full((300, 1), 10.0)
    diverging = np.nan_to_num(physical.evidence.measured)
    diverging[280:] = np.nan
    assert held_out_squares(physical, diverging) > 1e3 * held_out_squares(physical, wrong)
    assert nrmse(physical, diverging, 0) == DIVERGED_ERROR > nrmse(physical, wrong, 0)
    assert held_out_squares(physical, np.nan_to_num(physical.evidence.measured)) == 0.0
