"""What every combination of effects would leave, from the sensitivities of the present model alone."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.search import (
    COMBINATION_REACH,
    COMBINATION_REACH_NEAR_NOISE,
    COMBINATION_RIDGE,
    COMBINATIONS_ANY,
    COMBINATIONS_PLAIN,
    COMBINED_MOST_EFFECTS,
    NEAR_NOISE_CHI2,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitting
from rthm_analysis.diagnosis.search.judging import Selection, price
from rthm_analysis.diagnosis.search.pieces import Piece, is_plain, pieces_of
from rthm_core.compiled import Floats

Labels = frozenset[tuple[str, str, str]]
"""Block, kind and place of the effects of a combination."""


class Left(NamedTuple):
    """What a combination would leave, with the price of its parameters, and the factors on its sizes."""

    error: float
    some: tuple[int, ...]
    sizes: list[Floats]


def promised(fitting: Fitting, selection: Selection) -> dict[Labels, list[Piece]]:
    """Combinations that were not asked yet and would leave least, each with its largest effect first.

    Raises
    ------
    numpy.linalg.LinAlgError
        Where the present model has no finite sensitivities.
    """
    base, best = len(selection.base.model.parameters), selection.best
    every = range(len(best.model.parameters))
    residual = fitting.residual(best.model)
    columns = fitting.thinned(fitting.columns(best.model, residual, every))
    pieces = pieces_of(fitting, selection, columns, residual)
    here = fitting.thinned(fitting.projected(residual))
    tables = _Tables(columns[:base], best.sums.precision[:base], here, pieces)
    near = COMBINATION_REACH_NEAR_NOISE if _may_imitate(selection) else 0.0
    reach = COMBINATION_REACH if fitting.reduced_chi2 > NEAR_NOISE_CHI2 else near
    least: dict[Labels, Left] = {}
    for one in sorted(_worth_it(tables, fitting.reduced_chi2, reach), key=lambda one: one.error):
        labels = frozenset(pieces[i].start.label for i in one.some)
        if labels not in fitting.asked:
            least.setdefault(labels, one)
    plain = [key for key, one in least.items() if all(is_plain(pieces[i].start) for i in one.some)]
    plain = plain[:COMBINATIONS_PLAIN]
    rest = [key for key in least if key not in plain][:COMBINATIONS_ANY]
    others = rest if fitting.reduced_chi2 > NEAR_NOISE_CHI2 or not plain else []
    return {key: _largest_first(pieces, least[key]) for key in (*plain, *others)}


def _may_imitate(selection: Selection) -> bool:
    """Whether any of what is there has enough freedom to stand for plain kinds."""
    return not all(is_plain(tried[0].start) for tried in selection.rounds)


def _worth_it(tables: _Tables, reduced_chi2: float, reach: float) -> Iterator[Left]:
    """Combinations that would leave no more than the present one does, about; far from the noise, plain ones
    whatever they leave.
    """
    pieces = tables.pieces
    present = tuple(i for i, one in enumerate(pieces) if one.index is not None)
    count = sum(len(pieces[i].columns) for i in present)
    now = (1.0 + reach) * (tables.left(present)[0] + reduced_chi2 * price(len(present), count))
    for count in range(1, COMBINED_MOST_EFFECTS + 1):
        for some in combinations(range(len(pieces)), count):
            if some != present and _can_be(pieces, some):
                left, sizes = tables.left(some)
                left += reduced_chi2 * price(count, sum(len(pieces[i].columns) for i in some))
                anyway = reduced_chi2 > NEAR_NOISE_CHI2 and all(is_plain(pieces[i].start) for i in some)
                if sizes is not None and (left < now or anyway):
                    yield Left(left, some, sizes)


def _can_be(pieces: list[Piece], some: tuple[int, ...]) -> bool:
    """Whether effects can stand beside each other; of what could be anything only one is looked for."""
    rubbed = [place for i in some if (place := pieces[i].rubs_at) is not None]
    alone = len(set(rubbed)) == len(rubbed) and sum(pieces[i].bends for i in some) <= 1
    return alone and all(i in some for i, one in enumerate(pieces) if one.stays)


def _largest_first(pieces: list[Piece], left: Left) -> list[Piece]:
    """Pieces of a combination with the sizes that they would have."""
    found = [pieces[i].sized(size) for i, size in zip(left.some, left.sizes, strict=True)]
    return sorted(found, key=lambda one: -float(one.whole @ one.whole))


class _Tables:
    """Products of all columns, from which every combination is solved.

    Parameters
    ----------
    known : (q, u k) array
        Columns of what is uncertain in the spec.
    precision : (q,) array
    here : (u k,) array
        Residual.
    pieces : list of Piece
    """

    def __init__(self, known: Floats, precision: Floats, here: Floats, pieces: list[Piece]) -> None:
        columns = np.vstack([*(one.columns for one in pieces), *(one.whole for one in pieces), here])
        self.pieces = pieces
        ends = np.cumsum([0, *(len(one.columns) for one in pieces)])
        self.places = [list(range(int(a), int(b))) for a, b in pairwise(ends)]
        self.wholes = int(ends[-1])
        shared = columns @ known.T
        whole = known @ known.T + np.diag(precision)
        self.products = columns @ columns.T - shared @ np.linalg.pinv(whole, hermitian=True) @ shared.T
        self.products[np.diag_indices_from(self.products)] *= 1.0 + COMBINATION_RIDGE

    def left(self, some: tuple[int, ...]) -> tuple[float, list[Floats] | None]:
        """Squared error that a combination leaves, and the factors on the columns of each of its pieces.

        None where one of them would have to be negative and cannot.
        """
        own = [i for one in some for i in self.places[one]]
        gone = [i for i, one in enumerate(self.pieces) if one.index is not None and i not in some]
        target = [-1, *(self.wholes + i for i in gone)]
        seen = self.products[:, target].sum(axis=1)
        found = np.linalg.solve(self.products[np.ix_(own, own)], seen[own])
        ends = np.cumsum([0, *(len(self.places[i]) for i in some)])
        sizes = [found[a:b] for a, b in pairwise(ends)]
        possible = all(self.pieces[i].may_have(size) for i, size in zip(some, sizes, strict=True))
        return float(seen[target].sum() - found @ seen[own]), sizes if possible else None
