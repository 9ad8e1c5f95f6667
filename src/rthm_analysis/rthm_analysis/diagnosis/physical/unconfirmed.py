"""What shows in the unseen part alone: described from the whole recording, and unconfirmed."""

from __future__ import annotations

from rthm_analysis.diagnosis.criteria.missing import OPEN_ENDED_GAIN_SHARE, UNCONFIRMED_SHARE
from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.missing.binned import binned
from rthm_analysis.diagnosis.missing.curves import Regression, free_curves
from rthm_analysis.diagnosis.missing.describe import NAMES, domain_of, law_of, symmetry_of, takes_energy
from rthm_analysis.diagnosis.missing.formulas import composed, open_ended
from rthm_analysis.diagnosis.numbers import bare
from rthm_analysis.diagnosis.physical.locating import when
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.physical.written import Written
from rthm_analysis.diagnosis.result import Described, Value


def unconfirmed(judged: Judgement) -> tuple[Described, ...]:
    """The one term that explains most of what is left, if it does so in data left out of its fit."""
    physical = judged.physical
    model = judged.told_fit.model
    physical.fitting.progress("asking what changed in the unseen part")
    end = physical.evidence.time.size
    regression = Regression(physical.experiment, physical.windows, physical.noise, model, end)
    curves = free_curves(regression)
    terms = composed(regression, curves, most=1)
    if not terms or terms[0].gain < UNCONFIRMED_SHARE * max(one.excess for one in curves):
        return ()
    without_end = open_ended(regression, terms)[0]
    is_open = without_end.gain > OPEN_ENDED_GAIN_SHARE * terms[0].gain
    term, dofs = without_end if is_open else terms[0], model.spec.plant.dofs if model.spec.plant else ()
    at = regression.along(dofs.index(term.dof))
    force = term.size * term.column(at)[:, 0]
    variables = tuple(name for name in at._fields if name in term.depends_on)
    variable = variables[0] if variables else "x"
    where, mean, spread, _ = binned(at._asdict()[variable], force)
    values = {name: Value(value, float("nan"), "") for name, value in term.numbers.items()}
    formula = Written(term.formula, values)
    interval = formula.interval(float(at.t[-1])) or when(judged)
    share = term.gain / max(one.excess for one in curves)
    text = formula.told(with_std=False)
    on = enumerated(NAMES[name].format(dof=term.dof) for name in variables)
    since = f" from {bare(interval[0])} s to {bare(interval[1])} s" if interval else ""
    words = (
        f"Of a force at {term.dof} that depends on {on}, {law_of(text, variables)}, the last third shows "
        f"something{since}; nothing confirms it: record longer."
    )
    return (
        Described(
            "plant", term.dof, None, variables, symmetry_of(where, mean) if variable != "t" else "neither",
            takes_energy(force, at), False, interval, text, domain_of(at, variables), share, 0.0, where, mean,
            spread, words,
        ),
    )  # fmt: skip
