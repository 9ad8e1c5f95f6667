"""From the measured force of a wire to a formula of what it has beyond a linear spring."""

from __future__ import annotations

from rthm_analysis.diagnosis.missing.sampled import fitted_terms, sampled
from rthm_analysis.diagnosis.physical.composing import is_earned, with_formulas
from rthm_analysis.diagnosis.physical.formula_model import guess_of
from rthm_analysis.diagnosis.physical.polygon import polygon_over
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.physical.wire_curves import Beyond, beyond_springs, foretold_share
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.effects.written import WireFormula

OVER = WireFormula.variables()[0]


def compose_wires(judged: Judgement) -> Judgement | None:
    """The model with a formula for every wire whose force is a curve of its elongation, or with that curve
    itself, judged; None where neither does on unseen data what the curve does.
    """
    physical, base = judged.physical, judged.told_fit
    wires = [one for one in beyond_springs(physical) if foretold_share(one, physical.train) is not None]
    if not wires:
        return None
    physical.fitting.progress("looking for a formula of the wires' forces")
    for guesses in (_by_terms(wires, physical.train), _by_bends(wires, physical.train)):
        found = with_formulas(judged, base, guesses) if guesses else None
        if found is not None and is_earned(judged, found, 1.0):
            return found
    return None


def _by_terms(wires: list[Beyond], train: int) -> list[InitialGuess]:
    found = []
    for one in wires:
        over, force = one.of_elongation(train)
        terms = fitted_terms(sampled(OVER, over, force, one.noise), one.name)
        found += [guess_of(term, WireFormula) for term in terms]
    return found


def _by_bends(wires: list[Beyond], train: int) -> list[InitialGuess]:
    curves = [(one, sampled(OVER, *one.of_elongation(train), one.noise)) for one in wires]
    return [polygon_over(WireFormula, one.name, OVER, curve.at, curve.mean) for one, curve in curves]
