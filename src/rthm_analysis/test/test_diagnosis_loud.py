"""Noise that is much louder than the spec says is told: what hides in it is not looked for."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.loud import loud
from rthm_core.spec import apply

from .faulty import PLAIN, plain


def told(noise: float, position: float) -> list[str]:
    spec = apply(PLAIN, {"noise": {"position": position}})
    return list(loud(diagnose_physical(plain(noise=noise), spec, np.empty(0), lambda said: None)))


def test_noise_is_told_where_it_is_louder_than_the_spec_says() -> None:
    (said,) = told(10.0, 1e-4)
    assert "noise of the position of x1 is 9.8 times what the spec says, 0.977 mm instead of 0.1 mm" in said
    assert not told(1.0, 1e-4)
    assert not told(10.0, 0.0)
