"""Where a fit of what wires do beyond linear springs begins: terms over the elongation, or a curve of it."""

from __future__ import annotations

from collections.abc import Sequence

from rthm_analysis.diagnosis.missing.sampled import fitted_terms, sampled
from rthm_analysis.diagnosis.physical.formula_model import guess_of
from rthm_analysis.diagnosis.physical.polygon import polygon_over
from rthm_analysis.diagnosis.physical.wire_curves import Beyond
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.effects.written import WireFormula

OVER = WireFormula.variables()[0]


def terms_of(wires: Sequence[Beyond], train: int) -> list[InitialGuess]:
    """Terms of each wire that fit the first samples of its force."""
    found = []
    for one in wires:
        over, force = one.of_elongation(train)
        terms = fitted_terms(sampled(OVER, over, force, one.noise), one.name)
        found += [guess_of(term, WireFormula) for term in terms]
    return found


def bends_of(wires: Sequence[Beyond], train: int) -> list[InitialGuess]:
    """The curve of each wire itself, straight between a few knots."""
    curves = [(one, sampled(OVER, *one.of_elongation(train), one.noise)) for one in wires]
    return [polygon_over(WireFormula, one.name, OVER, curve.at, curve.mean) for one, curve in curves]
