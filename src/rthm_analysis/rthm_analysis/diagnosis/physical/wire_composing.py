"""From the measured force of a wire to a formula of what it has beyond a linear spring."""

from __future__ import annotations

from rthm_analysis.diagnosis.physical.composing import is_earned, with_formulas
from rthm_analysis.diagnosis.physical.formula_model import with_all
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.physical.wire_curves import beyond_springs, foretold_share
from rthm_analysis.diagnosis.physical.wire_guesses import bends_of, terms_of


def compose_wires(judged: Judgement) -> Judgement | None:
    """The model with a formula for every wire whose force is a curve of its elongation, or with that curve
    itself, judged; None where neither does on unseen data what the curve does.
    """
    physical, base = judged.physical, judged.told_fit
    wires = [one for one in beyond_springs(physical) if foretold_share(one, physical.train) is not None]
    if not wires:
        return None
    physical.fitting.progress("looking for a formula of the wires' forces")
    for guesses in (terms_of(wires, physical.train), bends_of(wires, physical.train)):
        found = with_formulas(judged, base, with_all(base.model, guesses), guesses) if guesses else None
        if found is not None and is_earned(judged, found, 1.0):
            return found
    return None
