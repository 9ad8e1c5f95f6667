"""Formulas of the missing force: terms that explain as much as the best free curve, with few numbers.

Every free curve is a number of sizes with their normal equations, so a shape is compared with it by linear
algebra alone. The best ones are then fitted to the recording itself, term by term.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    BESIDE_GAIN_LEFT_SHARE,
    CURVE_GAIN,
    OPEN_ENDED_GAIN_SHARE,
    PLAIN_ALLOWED_SHARE,
    PLAIN_GAIN_SHARE,
    PLAIN_LEFT_RATIO,
    PRODUCT_GAIN_RATIO,
    PRODUCT_GAIN_SHARE_OF_REST,
    PRODUCT_LEAST_LEFT,
    PRODUCTS_REFINED,
    REFINING_STEPS,
    SHAPES_REFINED,
    TERM_GAIN_SHARE,
    TERMS_OF_A_FORMULA,
)
from rthm_analysis.diagnosis.missing.curves import CurveFit, Regression, beside
from rthm_analysis.diagnosis.missing.features import Curve, Feature, feature_of, knots_over
from rthm_analysis.diagnosis.missing.normal import Normal
from rthm_analysis.diagnosis.missing.plain import plain_laws
from rthm_analysis.diagnosis.missing.recurring import recurring, swinging
from rthm_analysis.diagnosis.missing.shapes import BEYOND, WITHIN, Shape, shapes_over
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_analysis.diagnosis.replay.model import Model
from rthm_core.effects.formula import evaluated

if TYPE_CHECKING:
    from rthm_core.compiled import Floats


def composed(
    regression: Regression,
    curves: list[CurveFit],
    most: int = TERMS_OF_A_FORMULA,
    *,
    plain: bool = True,
) -> tuple[Term, ...]:
    """Terms, `most` of them at most, that explain the missing force together, the one that explains most
    first; none where the free curves show no shape.

    Laws without numbers of their own are preferred where `plain` says so. A law of the load is also sought
    beside another gain of the load, as a law of the motion is beside another mass, damping and stiffness. A
    mass that changes has no formula.
    """
    curves = [one for one in curves if not one.feature.of_mass]
    terms = _composed(regression, curves, [], most, plain=plain)
    gain = next((_gain_of_load(regression, one.site) for one in terms if one.depends_on == ("load",)), None)
    if gain is None or most < 2:
        return tuple(terms)
    beside_gain = _composed(regression, curves, [gain], most, plain=plain)
    whole = max(one.excess for one in curves)
    left, other = (whole - sum(one.gain for one in some) for some in (terms, beside_gain))
    return tuple(beside_gain if other < BESIDE_GAIN_LEFT_SHARE * left - CURVE_GAIN else terms)


def has_plain(terms: Iterable[Term]) -> bool:
    """Whether some have no numbers of their own: else the same are found if plain laws are not preferred."""
    return any(not one.within for one in terms)


def plainest(regression: Regression, curves: list[CurveFit], term: Term) -> tuple[Term, ...]:
    """A term without numbers of its own that leaves hardly more than another, else that one.

    A law of the load may need another gain of the load beside it: it then is two terms.
    """
    whole = max(one.excess for one in curves)
    allowed = _allowed_beside(term, whole)
    ways: list[tuple[Term, ...]] = [(_best_plain(regression, term),)]
    if term.depends_on == ("load",):
        gain = _gain_of_load(regression, term.site)
        ways.append((gain, _best_plain(regression.beside(_response_of(regression, gain)), term)))
    return next((one for one in ways if whole - sum(part.gain for part in one) < allowed), (term,))


def _best_plain(regression: Regression, term: Term) -> Term:
    """The best term without numbers of its own, over one of the variables of another; that where none is."""
    at = regression.along(regression.site(term.site))
    laws = plain_laws(term.site, at, [one for one in term.depends_on if one != "t"])
    return max(each_fitted_to(regression, laws), key=lambda one: one.gain, default=term)


def open_ended(regression: Regression, terms: tuple[Term, ...]) -> tuple[Term, ...]:
    """The terms, those of a time that ends as terms that only begin: where the motion has faded by then, an
    end stands for nothing but what is not quite right of the rest.
    """
    found = list(terms)
    for index, term in enumerate(terms):
        if any(over == "t" and shape.text == WITHIN for over, shape in term.shapes):
            others = [_response_of(regression, one) for one in found if one is not term]
            beside_others = regression.beside(np.vstack(others)) if others else regression
            found[index] = fitted_to(beside_others, _without_end(term))
    return tuple(found)


def without_needless_end(regression: Regression, terms: tuple[Term, ...]) -> tuple[Term, ...]:
    """The terms without an end where each then explains as much."""
    found = open_ended(regression, terms)
    is_open = all(a.gain > OPEN_ENDED_GAIN_SHARE * b.gain for a, b in zip(found, terms, strict=True))
    return found if is_open else terms


def fitted_together(regression: Regression, terms: tuple[Term, ...]) -> tuple[Model, tuple[Term, ...]]:
    """The model of a regression with the values that fit best beside some terms, and the terms with theirs.

    A model that lacks a force has made up for it by other values.
    """
    model = regression.model
    responses = np.vstack([_response_of(regression, one) for one in terms])
    normal, scales = regression.normal_of_any_unit(responses)
    if normal is None:
        return model, terms
    first, values = regression.known.shape[0], model.values
    values[:first] += normal.sizes[:first]
    sizes = zip(terms, normal.sizes[first:] * scales, strict=True)
    return model.at(values), tuple(replace(one, size=float(size)) for one, size in sizes)


def _without_end(term: Term) -> Term:
    shapes = tuple(
        (over, Shape(BEYOND, shape.numbers[:1], shape.steps[:1]) if shape.text == WITHIN else shape)
        if over == "t"
        else (over, shape)
        for over, shape in term.shapes
    )
    return replace(term, shapes=shapes)


def _gain_of_load(regression: Regression, site: str) -> Term:
    return fitted_to(regression, Term(site, "1", (("load", Shape("w")),)))


def _composed(
    regression: Regression, curves: list[CurveFit], given: list[Term], most: int, *, plain: bool
) -> list[Term]:
    """Terms behind some that are given."""
    terms = [*given]
    columns = [_response_of(regression, one) for one in given]
    if given:
        curves = beside(curves, regression, np.vstack(columns))
    whole = max((one.excess for one in curves), default=0.0)
    least = max(CURVE_GAIN, TERM_GAIN_SHARE * whole)
    while curves and len(terms) < most and not (terms and regression.spent):
        candidates = [one for curve in curves for one in shown_by(curve)]
        candidates += [] if terms else [*swinging(regression), *recurring(regression)]
        best = _best_of_each_form(candidates)[:SHAPES_REFINED]
        more = regression.beside(np.vstack(columns)) if columns else regression
        refined = each_fitted_to(more, [one for one in best if one.gain > least])
        found = max(refined, key=lambda one: one.gain, default=None)
        excess = max(one.excess for one in curves)
        if found is None or found.gain < least:
            break
        if excess - found.gain > PRODUCT_LEAST_LEFT:
            products = each_fitted_to(more, _products(more, found, excess - found.gain))
            found = max([found, *products], key=lambda one: one.gain)
            others = each_fitted_to(more, _with_another_first(more, found))
            found = max([found, *others], key=lambda one: one.gain)
        found = _plain_instead(more, curves[0], found, excess) if plain else found
        terms.append(found)
        if len(terms) == most:
            break
        columns.append(_response_of(regression, found))
        curves = beside(curves, regression, np.vstack(columns))
    return terms


def _best_of_each_form(terms: Iterable[Term]) -> list[Term]:
    """The best term of each form, the best first: others of a form end where the best does."""
    found: dict[str, Term] = {}
    for one in sorted(terms, key=lambda one: -one.gain):
        found.setdefault(one.formula, one)
    return list(found.values())


def _plain_instead(regression: Regression, curve: CurveFit, term: Term, excess: float) -> Term:
    """A plain law over the variables of a curve, where it leaves hardly more than a term; else the term.

    Between its knots a free curve is straight, so that it shows a high power badly.
    """
    over = [one for one in curve.feature.depends_on if one != "t"]
    plain = each_fitted_to(regression, plain_laws(curve.site, curve.at, over, products=True))
    best = max(plain, key=lambda one: one.gain, default=term)
    allowed = max(_allowed_beside(term, excess), CURVE_GAIN)
    return best if best.gain > term.gain or (term.within and excess - best.gain < allowed) else term


def _allowed_beside(term: Term, excess: float) -> float:
    """What a law without numbers of its own may leave of an excess, to be taken instead of a term."""
    left = max(excess - term.gain, 0.0)
    most = min(PLAIN_LEFT_RATIO * left, left + (1.0 - PLAIN_GAIN_SHARE) * term.gain)
    return max(most, left + PLAIN_ALLOWED_SHARE * term.gain)


def _products(regression: Regression, term: Term, left: float) -> list[Term]:
    """The best products of a term with a shape over another variable, where these do clearly better, or
    explain much of what is left.
    """
    least = term.gain + min((PRODUCT_GAIN_RATIO - 1.0) * term.gain, PRODUCT_GAIN_SHARE_OF_REST * left)
    site = regression.site(term.site)
    at = regression.along(site)
    over, found = term.shapes[0][0], []
    for variable, values in at._asdict().items():
        if variable == over or not np.any(values):
            continue
        carrier = "1" if term.carrier == variable else term.carrier
        own = replace(term, carrier=carrier)
        curve = Curve(own.with_values, variable, knots_over(at, variable))
        fit = regression.fit(feature_of(at, curve), site)
        if fit is None or fit.gain < least:
            continue
        kept = tuple(one for one in own.shapes if one[1].text != "1")
        shown = sorted(shown_by(fit), key=lambda one: -one.gain)[:PRODUCTS_REFINED]
        found += [replace(own, shapes=(*kept, *one.shapes), gain=one.gain) for one in shown]
    return found


def _with_another_first(regression: Regression, product: Term) -> list[Term]:
    """A product of two shapes with others in the place of the first, which was chosen without the second."""
    if len(product.shapes) < 2:
        return []
    (over, _), second = product.shapes
    site = regression.site(product.site)
    at = regression.along(site)
    curve = Curve(replace(product, shapes=(second,)).with_values, over, knots_over(at, over))
    fit = regression.fit(feature_of(at, curve), site)
    shown = sorted(shown_by(fit), key=lambda one: -one.gain)[:PRODUCTS_REFINED] if fit else []
    return [replace(product, shapes=(*one.shapes, second), gain=one.gain) for one in shown]


def _response_of(regression: Regression, term: Term) -> Floats:
    site = regression.site(term.site)
    return regression.response(term.column(regression.along(site)), site)


def shown_by(fit: CurveFit) -> list[Term]:
    """The best shapes of each curve of a feature, with the gain that each has within the curve; none of a
    straight line over time, and of a mass that changes, which has no formula.
    """
    if fit.normal is None or fit.feature.straight or fit.feature.of_mass:
        return []
    first = fit.normal.prior.shape[0] - fit.feature.count
    found, base = [], fit.normal.leading(first)
    for curve, columns in _columns(fit.feature, first):
        shapes = list(shapes_over(curve.over, curve.knots))
        knots = curve.knots if curve.knots.size else np.zeros(1)
        vectors = np.stack([_at_knots(one, knots) for one in shapes], axis=1)
        gains = _gains(fit.normal, first, columns, vectors)
        forms: set[str] = set()
        for index in np.argsort(-gains):
            if len(forms) == SHAPES_REFINED or gains[index] < CURVE_GAIN:
                break
            if shapes[index].text in forms:
                continue
            forms.add(shapes[index].text)
            gain = _left_out_gain(fit.normal, base, columns, vectors[:, index])
            found.append(Term(fit.site, curve.carrier, ((curve.over, shapes[index]),), gain=gain))
    return found


def _columns(feature: Feature, first: int) -> list[tuple[Curve, slice]]:
    """Curves of a feature, and where their sizes are."""
    found = []
    for curve in feature.curves:
        found.append((curve, slice(first, first + curve.count)))
        first += curve.count
    return found


def _at_knots(shape: Shape, knots: Floats) -> Floats:
    numbers = dict(zip("pq", shape.numbers, strict=False))
    found = evaluated(shape.text, numbers, w=knots)
    return np.asarray(np.nan_to_num(found, nan=0.0, posinf=0.0, neginf=0.0))


def _gains(normal: Normal, first: int, columns: slice, vectors: Floats) -> Floats:
    """Squared error (n,) that each direction (p, n) of some sizes removes beside what is known."""
    hessian, gradient = normal.total
    known, own = hessian[:first, :first], hessian[columns, columns]
    ridge = 1e-12 * (np.trace(known) + 1.0) * np.eye(first)
    factor = np.linalg.solve(known + ridge, hessian[:first, columns])
    reduced = own - hessian[columns, :first] @ factor
    slope = gradient[columns] - factor.T @ gradient[:first]
    size = np.einsum("pn,pq,qn->n", vectors, reduced, vectors)
    scale = np.einsum("pn,pq,qn->n", vectors, own, vectors)
    clear = size > 1e-6 * scale
    return np.asarray(np.where(clear, np.square(slope @ vectors) / np.where(clear, size, 1.0), 0.0))


def _left_out_gain(normal: Normal, base: Normal, columns: slice, vector: Floats) -> float:
    directions = np.zeros((normal.prior.shape[0], base.prior.shape[0] + 1))
    directions[: base.prior.shape[0], :-1] = np.eye(base.prior.shape[0])
    directions[columns, -1] = vector
    return float(base.left_out().sum() - normal.within(directions).left_out().sum())


def each_fitted_to(regression: Regression, terms: Iterable[Term], most: int = REFINING_STEPS) -> list[Term]:
    """The terms with the numbers of their shapes, and their sizes, each fitted to the recording by itself."""
    allowed = 0 if regression.spent else most
    return regression.fitting.cores.each_in_parts(lambda one: fitted_to(regression, one, allowed), terms)


def fitted_to(regression: Regression, term: Term, most: int = REFINING_STEPS) -> Term:
    """The term with the numbers of its shape, and its size, fitted to the recording."""
    from scipy.optimize import minimize

    def with_size(numbers: Floats) -> Term:
        moved = term.moved(numbers)
        normal, scales = regression.normal_of_any_unit(_response_of(regression, moved))
        if normal is None:
            return replace(moved, gain=-np.inf)
        gain = regression.left_known - float(normal.left_out().sum())
        return replace(moved, size=float(normal.sizes[-1] * scales[-1]), gain=gain)

    start = np.array(term.within)
    best = with_size(start)
    if not start.size or not most:
        return best
    tried = {best.within: best}

    def loss(numbers: Floats) -> float:
        key = tuple(map(float, numbers))
        if key not in tried:
            tried[key] = with_size(numbers)
        return -max(tried[key].gain, 0.0)

    corners = np.vstack([start, start + np.diag(term.steps)])
    minimize(
        loss,
        start,
        method="Nelder-Mead",
        options={"initial_simplex": corners, "maxfev": most, "xatol": 1e-12, "fatol": 0.1},
    )
    return max(tried.values(), key=lambda one: one.gain)
