"""What shows in the unseen part alone: described from the whole recording, and unconfirmed."""

from __future__ import annotations

from rthm_analysis.diagnosis.criteria.missing import UNCONFIRMED_SHARE
from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.missing.binned import binned
from rthm_analysis.diagnosis.missing.curves import Regression, free_curves
from rthm_analysis.diagnosis.missing.describe import NAMES, domain_of, law_of, symmetry_of, takes_energy
from rthm_analysis.diagnosis.missing.formulas import composed, without_needless_end
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_analysis.diagnosis.missing.within import excess_of
from rthm_analysis.diagnosis.numbers import bare
from rthm_analysis.diagnosis.physical.acting import acting, acting_terms
from rthm_analysis.diagnosis.physical.locating import when
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.physical.written import Written
from rthm_analysis.diagnosis.result import Described, Value


def unconfirmed(judged: Judgement, *, from_time_to_time: bool = False) -> tuple[Described, ...]:
    """The one term that explains most of a force that acts from time to time, or else of what is left, if it
    does so in data left out of its fit.
    """
    physical = judged.physical
    physical.fitting.progress("asking what changed")
    end = physical.evidence.time.size
    found = None if judged.earned else acting(physical, end)
    if found is not None:
        regression, terms = acting_terms(physical, found, end)
    elif from_time_to_time:
        return ()
    else:
        model = judged.told_fit.model
        regression = Regression(physical.experiment, physical.windows, physical.noise, model, end)
        terms = composed(regression, free_curves(regression), most=1)
    whole = excess_of(regression)
    if not terms or terms[0].gain < UNCONFIRMED_SHARE * whole:
        return ()
    terms = terms if found is not None else without_needless_end(regression, terms)
    return (_told(judged, regression, terms[0], whole),)


def _told(judged: Judgement, regression: Regression, term: Term, whole: float) -> Described:
    at = regression.along(regression.site(term.site))
    force = term.size * term.column(at)[:, 0]
    variables = tuple(name for name in at._fields if name in term.depends_on)
    variable = variables[0] if variables else "x"
    where, mean, spread, _ = binned(at._asdict()[variable], force)
    values = {name: Value(value, float("nan"), "") for name, value in term.numbers.items()}
    formula = Written(term.formula, values)
    interval = formula.interval(float(at.t[-1])) or when(judged)
    text = formula.told(with_std=False)
    on = enumerated(NAMES[name].format(dof=term.site) for name in variables)
    since = f" from {bare(interval[0])} s to {bare(interval[1])} s" if interval else ""
    late = interval is not None and interval[0] > at.t[judged.physical.train - 1]
    shown = "the last third shows something" if late else "the recording shows something"
    words = (
        f"Of a force at {term.site} that depends on {on}, {law_of(text, variables)}, {shown}{since}; nothing "
        f"confirms it: record longer."
    )
    symmetry = symmetry_of(where, mean) if variable != "t" else "neither"
    return Described(
        "plant", term.site, variables, symmetry, takes_energy(force, at), False, interval, text,
        domain_of(at, variables), term.gain / whole, 0.0, where, mean, spread, words,
    )  # fmt: skip
