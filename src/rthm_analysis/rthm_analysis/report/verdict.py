"""What a recording says in a few lines: the result of a test before any picture."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rthm_analysis.energy import EnergyResult
from rthm_analysis.outcome import Margin, Outcome
from rthm_analysis.outcome.outcome import UNSEEN, cycle_words, error_words
from rthm_analysis.timing import TimingResult

GOOD, NOTED, BAD = "good", "noted", "bad"


@dataclass(frozen=True)
class Fact:
    """One line of result.

    Attributes
    ----------
    label, value : str
        What it is about, and its figure with unit.
    words : str
        The line as a sentence.
    level : str
        ``good``, ``noted`` (a result, neither good nor bad) or ``bad``.
    """

    label: str
    value: str
    words: str
    level: str = NOTED


def verdict(energy: EnergyResult | None, timing: TimingResult, outcome: Outcome | None = None) -> list[Fact]:
    """Facts of a recording, the most important first."""
    return [
        *(_outcome(outcome) if outcome else []),
        *(_energies(energy) if energy else []),
        _deadlines(timing),
        _samples(timing),
    ]


def _outcome(outcome: Outcome) -> list[Fact]:
    """Stability, error against the ideal system, what late samples did, limits that were reached."""
    facts = []
    if isinstance(outcome.margin, Margin):
        stable = outcome.margin.stable
        facts.append(
            Fact("Loop", "stable" if stable else "unstable", outcome.stability, GOOD if stable else BAD)
        )
    for dof, error in outcome.error.items():
        value = f"{100.0 * error.nrmse:.3g} %" if math.isfinite(error.nrmse) else f"{error.largest:.3g} m"
        facts.append(Fact(f"{dof} against the ideal system", value, error_words(dof, error)))
    if outcome.lateness is not None:
        late = outcome.lateness
        changed = f"{100.0 * late.error:.2g} %" if late.error >= UNSEEN else "nothing"
        level = GOOD if late.ok else BAD
        facts.append(Fact("Late samples changed", changed, late.words, level))
    if outcome.energy_per_cycle is not None:
        facts.append(_per_cycle(outcome.energy_per_cycle))
    if outcome.limits_touched:
        reached = ", ".join(outcome.limits_touched)
        facts.append(Fact("Limits reached", reached, f"Limits that the test reached: {reached}.", BAD))
    return facts


def _per_cycle(work: float) -> Fact:
    verb = "taken out" if work < 0.0 else "put in"
    return Fact(f"Energy {verb} per cycle", f"{abs(work):.3g} J", cycle_words(work))


def _energies(energy: EnergyResult) -> list[Fact]:
    names = {"E_fx": "Position cancellation", "E_ff": "Force feedforward", "E_num": "Numerical side"}
    facts = [_work(name, float(energy.work[term][-1])) for term, name in names.items()]
    damping = energy.equivalent_damping
    if math.isfinite(damping):
        words = (
            f"Delays, holds and actuator act like a damper of {damping:.3g} N s/m between plant and ground."
        )
        facts.append(Fact("Equivalent damping", f"{damping:.3g} N s/m", words))
    return [fact for fact in facts if fact is not None]


def _work(name: str, work: float) -> Fact | None:
    if math.isnan(work):
        return None
    verb = "drained" if work < 0.0 else "introduced"
    return Fact(f"{name} {verb}", f"{abs(work):.4g} J", f"{name} {verb} {abs(work):.4g} J.")


def _deadlines(timing: TimingResult) -> Fact:
    missed = {name: clock.missed for name, clock in timing.clocks.items() if clock.missed}
    if not missed:
        return Fact("Missed deadlines", "none", "No deadline was missed.", GOOD)
    where = ", ".join(f"{count} of {name.capitalize()}" for name, count in missed.items())
    return Fact("Missed deadlines", str(sum(missed.values())), f"Deadlines were missed: {where}.", BAD)


def _samples(timing: TimingResult) -> Fact:
    lost, late = (sum(getattr(link, what) for link in timing.links.values()) for what in ("lost", "late"))
    if not lost and not late:
        return Fact("Lost or late samples", "none", "No sample was lost or late.", GOOD)
    return Fact(
        "Samples on the links",
        f"{lost} lost, {late} late",
        f"{lost} samples were lost and {late} were late.",
        BAD,
    )
