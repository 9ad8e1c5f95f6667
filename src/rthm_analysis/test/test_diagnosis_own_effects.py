"""A law of one's own is a candidate by its name where its file is loaded, and only there."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi, sin
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.result import Part, Value
from rthm_analysis.diagnosis.search.judging import imitates
from rthm_core.effects import load_effects, own, registry

from .plain import plant, recorded

LAW = """
import math
from rthm_core.effects import EffectParameter, Guess, PlantLaw, register

@register
class Ripple(PlantLaw):
    kind, blocks, flexible = "ripple", ("plant",), True
    parameters = {
        "amplitude": EffectParameter("N", "amplitude"),
        "period": EffectParameter("m", "way", above=0.0),
    }
    words = "a ripple of {amplitude} every {period} acts on {dof}"

    @staticmethod
    def force(x, v, z, t, p, mode):
        return p[0] * math.sin(2.0 * math.pi * x / p[1])

    @classmethod
    def guesses(cls, signals):
        reach = signals.x.max() - signals.x.min()
        for k in range(1, 30):
            values = {"amplitude": 0.02 * signals.size, "period": 2.0 * reach / k}
            yield Guess(values, linear=("amplitude",), signed=True)
"""


@pytest.fixture
def ripple(tmp_path: Path) -> Iterator[None]:
    before = set(registry.declared())
    (tmp_path / "ripple.py").write_text(LAW)
    load_effects([tmp_path / "ripple.py"])
    yield
    registry.forget(one for one in registry.declared() if one not in before)
    own._LOADED.clear()


def found() -> Part:
    """What is found where a force of 0.15 N every 0.1 m is concealed."""
    evidence = recorded(lambda t, x, v: 0.15 * sin(2.0 * pi * x / 0.1), duration=16.0)
    return physical_part(diagnose_physical(evidence, plant(), np.empty(0), lambda said: None))


@pytest.mark.usefixtures("ripple")
def test_a_law_of_ones_own_is_found_by_its_name_with_its_size() -> None:
    (one,) = found().physics
    amplitude, period = one.parameters["amplitude"], one.parameters["period"]
    assert one.kind == "ripple" and isinstance(amplitude, Value) and isinstance(period, Value)
    assert abs(amplitude.value - 0.15) < 4.0 * amplitude.std < 0.01
    assert abs(period.value - 0.1) < 4.0 * period.std < 0.001
    assert imitates("plant", "ripple")


def test_a_law_whose_file_nobody_named_is_not_looked_for() -> None:
    assert "ripple" not in {one.kind for one in found().physics}
