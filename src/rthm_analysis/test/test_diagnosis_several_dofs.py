"""Of several dofs the known force shows which position has another sign or unit, or another's place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from rthm_analysis.diagnosis.faults import mend
from rthm_analysis.diagnosis.replay.evidence import Evidence

from .test_diagnosis_between import recorded, two_dofs


@cache
def motion(*, rates: bool) -> Evidence:
    """A recording in which nothing is wrong, with its positions first, maybe with velocities behind each."""
    seen = recorded(lambda x, v: (0.0, 0.0), 12.0)
    order = [0, 2, 1, 3] if rates else [0, 1]
    channels = tuple(seen.channels[i] for i in order)
    return replace(seen, channels=channels, measured=seen.measured[:, order])


Told = list[tuple[str, str, object]]
Change = Callable[[np.ndarray], np.ndarray]


def told(
    seen: Evidence, change: Change, *, load: float = 1.0
) -> tuple[list[tuple[str, str, object]], Evidence]:
    mended = mend(replace(seen, measured=change(seen.measured.copy()), load=load * seen.load), two_dofs())
    return [(one.kind, one.channel, one.value) for one in mended.faults], mended.evidence


@pytest.mark.parametrize("rates", [False, True])
@pytest.mark.parametrize(("factor", "kind"), [(-1.0, "sign"), (1000.0, "unit")])
def test_a_position_with_another_sign_or_unit_is_told(rates: bool, factor: float, kind: str) -> None:
    seen = motion(rates=rates)
    second = 2 if rates else 1
    by = np.ones(seen.measured.shape[1])
    by[second] = factor
    faults, mended = told(seen, lambda measured: measured * by)
    assert faults == [(kind, "x2.position", factor)]
    assert mended.measured == pytest.approx(seen.measured)


@pytest.mark.parametrize(("rates", "order"), [(False, [1, 0]), (True, [2, 3, 0, 1]), (True, [2, 1, 0, 3])])
def test_motions_in_each_others_place_are_told(rates: bool, order: list[int]) -> None:
    seen = motion(rates=rates)
    faults, mended = told(seen, lambda measured: measured[:, order])
    moved = sum(at != i for i, at in enumerate(order)) // 2
    assert [kind for kind, _, _ in faults] == ["swapped"] * moved
    assert mended.measured == pytest.approx(seen.measured)


def test_a_known_force_with_another_sign_is_told_once_for_each_dof() -> None:
    faults, mended = told(motion(rates=False), lambda measured: measured, load=-1.0)
    assert [kind for kind, _, _ in faults] == ["sign", "sign"]
    assert mended.load == pytest.approx(motion(rates=False).load)


@pytest.mark.parametrize("gain", [1.0, 0.9])
def test_a_gain_that_is_no_unit_is_left_to_the_search(gain: float) -> None:
    assert not told(motion(rates=False), lambda measured: measured * [1.0, gain])[0]
