"""What combinations of pieces would leave, many at once, against a fit of each by itself."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from rthm_analysis.diagnosis.replay.model import EffectInstance
from rthm_analysis.diagnosis.search import tables as solving
from rthm_analysis.diagnosis.search.pieces import Piece
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_analysis.diagnosis.search.tables import Tables
from rthm_core.compiled import Floats

SAMPLES = 80
RNG = np.random.default_rng(0)
KNOWN, HERE, PRECISION = RNG.normal(size=(2, SAMPLES)), RNG.normal(size=SAMPLES), np.array([3.0, 0.0])


def piece(
    kind: str, width: int, index: int | None = None, place: str = "x1", free: tuple[str, ...] = ("size",)
) -> Piece:
    start = InitialGuess(EffectInstance("plant", kind, place, {}), free, ("size",))
    columns = RNG.normal(size=(width, SAMPLES))
    there = np.zeros(SAMPLES) if index is None else RNG.normal(size=SAMPLES)
    return Piece(start, index, columns, there)


PIECES = [
    piece("cubic_stiffness", 1, index=0),
    piece("coulomb_friction", 1, index=1),
    piece("quadratic_drag", 1),
    piece("coulomb_friction", 1, place="x2"),
    piece("harmonic_load", 2),
    piece("stribeck_friction", 1, free=("size", "velocity")),
]


def left_by_itself(some: tuple[int, ...]) -> tuple[float, Floats]:
    gone = [one.whole for i, one in enumerate(PIECES) if one.index is not None and i not in some]
    target = np.append(HERE + np.sum(gone, axis=0), np.zeros(2))
    columns = [np.hstack([one, np.zeros((len(one), 2))]) for one in (PIECES[i].columns for i in some)]
    known = np.hstack([KNOWN, np.diag(np.sqrt(PRECISION))])
    rows = np.vstack([known, *columns]).T
    sizes = np.linalg.lstsq(rows, target, rcond=None)[0]
    return float(np.sum(np.square(target - rows @ sizes))), sizes[2:]


@pytest.mark.parametrize("count", [1, 2, 3])
def test_what_combinations_leave_is_what_a_fit_of_each_leaves(
    count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(solving, "COMBINATIONS_AT_ONCE", 2)
    tables, seen = Tables(KNOWN, PRECISION, HERE, PIECES), set()
    for some in tables.in_parts(np.array(list(combinations(range(len(PIECES)), count)))):
        error, sizes = tables.left(some)
        for row, own in enumerate(some.tolist()):
            alone, fitted = left_by_itself(tuple(own))
            assert error[row] == pytest.approx(alone, rel=1e-6)
            assert sizes[row] == pytest.approx(fitted, rel=1e-6)
            seen.add(tuple(own))
    assert seen == set(combinations(range(len(PIECES)), count))


def test_friction_is_alone_at_its_place_and_of_what_bends_there_is_one() -> None:
    traits = Tables(KNOWN, PRECISION, HERE, PIECES).traits
    pairs = set(map(tuple, traits.possible(2).tolist()))
    assert (1, 3) in pairs
    assert (1, 5) not in pairs  # both rub at x1
    assert traits.bends.tolist() == [False, False, False, False, False, True]
    assert pairs == set(combinations(range(6), 2)) - {(1, 5)}


def test_what_takes_energy_out_is_not_negative() -> None:
    tables = Tables(KNOWN, PRECISION, HERE, PIECES)
    assert tables.traits.positive.tolist() == [
        not one.start.signed and i in (2, 3, 5) for i, one in enumerate(PIECES)
    ]
    assert tables.traits.positive[3]
    some = np.array([[2, 3], [2, 3], [0, 1]])
    sizes = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]])
    assert tables.may_have(some, sizes).tolist() == [True, False, True]
