"""What was found of a component, in sentences."""

from __future__ import annotations

from rthm_analysis.component.result import Errors, Term
from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.numbers import bare, number, percent
from rthm_analysis.diagnosis.result import Value

PLAIN = {"offset": "a constant force", "stiffness": "a spring", "damping": "a damper"}


def verdict_words(verdict: str, depends_on: tuple[str, ...], terms: tuple[Term, ...]) -> str:
    """What the force follows from."""
    if verdict == "unexplained":
        return (
            "No spring, damper or law of the library explains this force, alone or scaled by an input: what "
            "it follows from was not recorded, or is no law of the library."
        )
    before = ", and on what was before" if any(term.memory for term in terms) else ""
    parts = enumerated(PLAIN.get(term.kind, term.called) for term in terms)
    left = " Something is left that is not noise." if verdict == "improved" else ""
    return f"The force depends on {enumerated(depends_on)}{before}: {parts}.{left}"


def term_words(term: Term) -> str:
    """One part with its values, and what each input adds."""
    values = [_value(name, value, term) for name, value in term.parameters.items()]
    for of, added in term.by_input.items():
        for name, value in added.items():
            more = " more" if name in term.parameters else ""
            values.append(f"{_value(name, value, term)}{more} for each unit of {of}")
    return f"{PLAIN.get(term.kind, term.called)}: {', '.join(values)}"


def _value(name: str, value: Value, term: Term) -> str:
    told = number(value.value, value.std, value.unit, signed=True)
    return told if name == term.kind else f"{name} {told}"


def lag_words(name: str, lag: Value) -> str:
    """How late an input acts."""
    if lag.value <= 0.0:
        return f"{name}: no lag shows"
    return f"{name}: acts behind a lag of {number(lag.value, lag.std, 's')}"


def error_words(errors: Errors, force_std: float, held_out: str) -> str:
    """Errors on unseen data, over the force's standard deviation."""
    plain, found, noise = (percent(one / force_std, 3) for one in (errors.plain, errors.found, errors.noise))
    return (
        f"error of the force on unseen data ({held_out}), over its standard deviation: {plain} with spring "
        f"and damper, {found} as found; the noise alone is {noise}"
    )


def reversed_words(force: str, motion: str) -> str:
    """Note on a force that was recorded with the other sign."""
    return (
        f"The force {force} was recorded as that which the component exerts on what moves it: all values are "
        f"of the force that resists a motion of {motion} along +x."
    )


def denied_words(called: str) -> str:
    """Note on a law that is left out."""
    first = called[:1].upper() + called[1:]
    return f"{first} helped in the data that were fitted, and unseen data do not confirm it."


def sampled_words(first: float, last: float) -> str:
    """Stretch of a recording."""
    return f"{bare(first)} to {bare(last)} s"
