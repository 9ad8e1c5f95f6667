"""Plain laws, with a size and no other number, that explain a missing force together.

A model responds to each of them once; which set of them does best is then linear algebra. So laws are found
of which none shows by itself: a load that acts with its square and a spring that bends hide each other.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    PLAIN_LAWS_ALIKE,
    PLAIN_LAWS_TOGETHER,
    PLAIN_SETS_KEPT,
    PLAIN_TERM_LEFT_RATIO,
    SAME_LEFT_RATIO,
    SWINGING_ANGLES,
)
from rthm_analysis.diagnosis.missing.curves import Regression
from rthm_analysis.diagnosis.missing.normal import Normal, solved
from rthm_analysis.diagnosis.missing.shapes import PENDULUM, Shape
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_core.spec.effect import place_keys

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.missing.motion import Along
    from rthm_core.compiled import Floats

PLAIN_SHAPES = {
    "x": (PENDULUM, "w**3", "w**2", "w * abs(w)", "w**5", "abs(w)"),
    "v": ("w * abs(w)", "w**3", "w**2", "abs(w)", "w**5"),
    "load": ("w", "w**2", "w**3", "w * abs(w)", "abs(w)", "w**5"),
}
"""Shapes over each variable; of those that do as well, the first is taken."""

PLAIN_PRODUCTS = [(carrier, text) for carrier in ("v", "sign(v)") for text in ("w**2", "abs(w)", "w")]
"""Factors, and shapes over the position."""


class _Set(NamedTuple):
    """Numbers of some laws, and the squared error that they leave of data left out of their fit."""

    laws: tuple[int, ...]
    left: float


def plain_laws(
    site: str, at: Along, over: Sequence[str] = ("x", "v", "load"), *, products: bool = False
) -> list[Term]:
    """Plain laws at a site over some variables, none that is like another one along the recording; maybe with
    dampers and friction that grow with the position. A constant between two dofs is none: it would be the
    offset of a position sensor.
    """
    found = [] if place_keys(site)[1] else [Term(site, "1", (("x", Shape("1")),))]
    for one in over:
        shapes = [text for text in PLAIN_SHAPES[one] if text != PENDULUM or _may_be_angle(at.x)]
        found += [Term(site, "1", ((one, Shape(text)),)) for text in shapes]
    if "v" in over:
        found.append(Term(site, "sign(v)", (("v", Shape("1")),)))
    if products and {"x", "v"} <= set(over):
        found += [Term(site, carrier, (("x", Shape(text)),)) for carrier, text in PLAIN_PRODUCTS]
    return _unlike(found, at)


def plain_sets(regression: Regression, most: int = PLAIN_LAWS_TOGETHER) -> list[tuple[Term, ...]]:
    """The best set of plain laws of each size, up to the one beyond which further laws explain little; none
    where none explains anything.
    """
    laws: list[Term] = []
    responses = []
    for site, (name, _) in enumerate(regression.sites):
        at = regression.along(site)
        own = plain_laws(name, at)
        responses.append(regression.response(np.hstack([one.column(at) for one in own]), site))
        laws += own
    normal, _ = regression.normal_of_any_unit(np.vstack(responses))
    if normal is None:
        return []
    sets = list(_best_sets(normal, laws, most))
    chosen = 0
    for size in range(1, len(sets)):
        if sets[size].left < PLAIN_TERM_LEFT_RATIO ** (size - chosen) * sets[chosen].left:
            chosen = size
    return [_largest_first(normal, laws, one.laws) for one in sets[1 : chosen + 1]]


def _largest_first(normal: Normal, laws: list[Term], some: tuple[int, ...]) -> tuple[Term, ...]:
    """Some laws, the one first to whose force the model responds most."""
    first = normal.prior.shape[0] - len(laws)
    there = _within(normal, first, some)
    responses = np.square(there.sizes[first:]) * np.diag(there.hessian.sum(0))[first:]
    return tuple(laws[some[i]] for i in np.argsort(-responses))


def _may_be_angle(x: Floats) -> bool:
    return bool(SWINGING_ANGLES[0] < np.abs(x).max() < SWINGING_ANGLES[1])


def _unlike(laws: list[Term], at: Along) -> list[Term]:
    """The laws without those that are another one, or a spring or a damper, in all that was recorded."""
    columns, found = [at.x, at.v], []
    for one in laws:
        column = one.column(at)[:, 0]
        size = float(np.linalg.norm(column))
        alike = (abs(column @ other) / max(size * float(np.linalg.norm(other)), 1e-300) for other in columns)
        if size > 0.0 and max(alike) < PLAIN_LAWS_ALIKE:
            columns.append(column)
            found.append(one)
    return found


def _best_sets(normal: Normal, laws: list[Term], most: int) -> Iterator[_Set]:
    """The best set of each size, beginning with none: the best ones of a size are what the next are made of.

    What the spec says of its own values counts for less the more of the force the laws explain.
    """
    first = normal.prior.shape[0] - len(laws)
    best = _Set((), float(normal.leading(first).left_out().sum()))
    whole, kept = best.left, [best]
    yield best
    for _ in range(most):
        here = replace(normal, prior=normal.prior * best.left / whole)
        tried = {tuple(sorted({*one.laws, i})) for one in kept for i in range(len(laws)) if i not in one.laws}
        ranked = sorted(tried, key=lambda some: _squares(_within(here, first, some)))[:PLAIN_SETS_KEPT]
        kept = [_Set(some, float(_within(here, first, some).left_out().sum())) for some in ranked]
        if not kept:
            return
        least = min(one.left for one in kept)
        alike = [one for one in kept if one.left < SAME_LEFT_RATIO * least]
        best = min(alike, key=lambda one: sum(map(_rank, (laws[i] for i in one.laws))))
        yield best


def _within(normal: Normal, first: int, some: Sequence[int]) -> Normal:
    """Normal equations of what is known and of some laws."""
    return normal.within(np.eye(normal.prior.shape[0])[:, [*range(first), *(first + i for i in some)]])


def _squares(normal: Normal) -> float:
    """Squared error that the best sizes leave."""
    hessian, gradient = normal.total
    return float(normal.squares.sum() - gradient @ solved(hessian, gradient)[0])


def _rank(law: Term) -> int:
    """Place of a law among those over its variable."""
    over, shape = law.shapes[0]
    return PLAIN_SHAPES[over].index(shape.text) if shape.text in PLAIN_SHAPES[over] else 0
