"""What every combination of effects would leave, from the sensitivities of the present model alone."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.search import (
    COMBINATION_REACH,
    COMBINATION_REACH_NEAR_NOISE,
    COMBINATIONS_ANY,
    COMBINATIONS_PLAIN,
    COMBINED_MOST_EFFECTS,
    NEAR_NOISE_CHI2,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitting
from rthm_analysis.diagnosis.search.judging import Selection, price
from rthm_analysis.diagnosis.search.pieces import Piece, is_plain, pieces_of
from rthm_analysis.diagnosis.search.tables import Tables
from rthm_core.compiled import Floats, Integers

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
    tables = Tables(columns[:base], best.sums.precision[:base], here, pieces)
    near = COMBINATION_REACH_NEAR_NOISE if _may_imitate(selection) else 0.0
    reach = COMBINATION_REACH if fitting.reduced_chi2 > NEAR_NOISE_CHI2 else near
    least: dict[Labels, Left] = {}
    for one in sorted(_worth_it(tables, fitting.reduced_chi2, reach), key=lambda one: one[:2]):
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


def _worth_it(tables: Tables, reduced_chi2: float, reach: float) -> Iterator[Left]:
    """Combinations that would leave no more than the present one does, about; far from the noise, plain ones
    whatever they leave.
    """
    traits = tables.traits
    present, far = np.flatnonzero(traits.there), reduced_chi2 > NEAR_NOISE_CHI2

    def left(some: Integers) -> tuple[Floats, Floats]:
        error, sizes = tables.left(some)
        return error + reduced_chi2 * price(some.shape[1], sizes.shape[1]), sizes

    most = (1.0 + reach) * float(left(present[None])[0][0])
    for count in range(1, COMBINED_MOST_EFFECTS + 1):
        for some in tables.in_parts(traits.possible(count)):
            error, sizes = left(some)
            is_other = count != present.size or (some != present).any(axis=1)
            worth = (error < most) | (far & traits.plain[some].all(axis=1))
            for row in np.flatnonzero(is_other & worth & tables.may_have(some, sizes)):
                ends = np.cumsum(traits.columns[some[row]])[:-1]
                yield Left(float(error[row]), tuple(some[row].tolist()), np.split(sizes[row], ends))


def _largest_first(pieces: list[Piece], left: Left) -> list[Piece]:
    """Pieces of a combination with the sizes that they would have."""
    found = [pieces[i].sized(size) for i, size in zip(left.some, left.sizes, strict=True)]
    return sorted(found, key=lambda one: -float(one.whole @ one.whole))
