"""Formulas of what is known sample by sample: the force of a wire, the error of a motor."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    CURVE_GAIN,
    SAMPLED_BINS,
    SAMPLED_FIT_STEPS,
    SAMPLED_GAIN_PER_NUMBER,
    SAMPLED_GAIN_SHARE_OF_REST,
    SAMPLED_LARGEST_RATIO,
    SAMPLED_SHAPES_REFINED,
    TERMS_OF_A_FORMULA,
)
from rthm_analysis.diagnosis.missing.binned import binned
from rthm_analysis.diagnosis.missing.shapes import Shape, shapes_over
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_core.compiled import Floats
from rthm_core.effects.formula import evaluated


class Sampled(NamedTuple):
    """A signal over a variable: means (b,) of bins, and the standard deviations of these."""

    variable: str
    at: Floats
    mean: Floats
    std: Floats

    def column(self, term: Term) -> Floats:
        """A term of size 1 at the bins, over the standard deviations."""
        found = evaluated(term.factors, term.numbers, **{self.variable: self.at})
        return np.asarray(np.nan_to_num(found, nan=0.0, posinf=0.0, neginf=0.0) / self.std)


def sampled(variable: str, over: Floats, signal: Floats, noise: float) -> Sampled:
    """A signal (s,) with white noise over a variable (s,), in even bins."""
    edges = np.linspace(float(over.min()), float(over.max()), SAMPLED_BINS + 1)
    at, mean, spread, _ = binned(over, signal, edges)
    count = np.histogram(over, edges)[0]
    return Sampled(variable, at, mean, np.maximum(spread, noise / np.sqrt(count[count > 0])))


def fitted_terms(curve: Sampled, place: str, most: int = TERMS_OF_A_FORMULA) -> tuple[Term, ...]:
    """Terms that fit a curve together, maybe beside a straight line; none where it is but noise."""
    line = Term(place, "1", ((curve.variable, Shape("w")),))
    alone, beside = (_greedy(curve, place, given, most) for given in ([], [line]))
    return tuple(min((alone, beside), key=_price)[0])


def _price(found: tuple[list[Term], float]) -> float:
    """What terms leave, and what their numbers and their shapes would gain by chance."""
    return found[1] + SAMPLED_GAIN_PER_NUMBER * sum(len(one.numbers) + 1 for one in found[0])


def _greedy(curve: Sampled, place: str, given: list[Term], most: int) -> tuple[list[Term], float]:
    """Terms beside those that are given, one after the other, and the squared error that they leave."""
    terms, left = _refined(curve, given)
    while len(terms) < most and left > curve.at.size:
        found, after = min(_extended(curve, place, terms), key=_price)
        if left - after < max(SAMPLED_GAIN_SHARE_OF_REST * left, CURVE_GAIN):
            break
        terms, left = found, after
    return terms, left


def _extended(curve: Sampled, place: str, terms: list[Term]) -> Iterable[tuple[list[Term], float]]:
    """The terms with one more, refined, and the squared error that they leave."""
    shapes = [Term(place, "1", ((curve.variable, one),)) for one in shapes_over(curve.variable, curve.at)]
    before = np.array([curve.column(one) for one in terms]).reshape(len(terms), curve.at.size).T
    target = curve.mean / curve.std
    columns = np.array([curve.column(one) for one in shapes]).T
    if before.size:
        basis = np.linalg.qr(before)[0]
        target, columns = target - basis @ (basis.T @ target), columns - basis @ (basis.T @ columns)
    square = np.sum(np.square(columns), axis=0)
    gains = np.where(square > 1e-12, np.square(target @ columns) / np.maximum(square, 1e-12), 0.0)
    for index in np.argsort(-gains)[:SAMPLED_SHAPES_REFINED]:
        found, left = _refined(curve, [*terms, shapes[index]])
        yield found, np.inf if _cancel(curve, found) else left


def _cancel(curve: Sampled, terms: list[Term]) -> bool:
    """Whether terms are far larger than what they are to fit: they then stand for nothing."""
    largest = max(float(np.abs(one.size * curve.column(one) * curve.std).max()) for one in terms)
    return largest > SAMPLED_LARGEST_RATIO * float(np.abs(curve.mean).max())


def _refined(curve: Sampled, terms: list[Term]) -> tuple[list[Term], float]:
    """The terms with the numbers within all shapes and their sizes, and the squared error that they leave."""
    from scipy.optimize import least_squares

    target, counts = curve.mean / curve.std, np.cumsum([0, *(len(one.within) for one in terms)])

    def moved(numbers: Floats) -> list[Term]:
        return [one.moved(numbers[a:b]) for one, a, b in zip(terms, counts[:-1], counts[1:], strict=True)]

    def solved(numbers: Floats) -> tuple[Floats, Floats]:
        columns = np.array([curve.column(one) for one in moved(numbers)]).T
        sizes = np.linalg.lstsq(columns, target, rcond=None)[0]
        return sizes, target - columns @ sizes

    if not terms:
        return [], float(target @ target)
    start = np.array([value for one in terms for value in one.within])
    steps = np.array([step for one in terms for step in one.steps])

    def left_at(moves: Floats) -> Floats:
        return solved(start + steps * moves)[1]

    best = start
    if start.size:
        best = start + steps * least_squares(left_at, 0.0 * start, max_nfev=SAMPLED_FIT_STEPS).x
    sizes, left = solved(best)
    found = [replace(one, size=float(size)) for one, size in zip(moved(best), sizes, strict=True)]
    return found, float(left @ left)
