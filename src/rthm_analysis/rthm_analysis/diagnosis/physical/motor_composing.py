"""A formula of what motors do beside their commands, where the forces of their wires do the same."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import FORETOLD_SHARE, SAMPLED_TRAINED
from rthm_analysis.diagnosis.criteria.verdict import DRIVE_STEPS
from rthm_analysis.diagnosis.fitting.fitting import Fitted
from rthm_analysis.diagnosis.missing.sampled import fitted_terms, sampled
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_analysis.diagnosis.physical.beginning import Baseline
from rthm_analysis.diagnosis.physical.driven import drives_earned, forces_are_off, forces_follow
from rthm_analysis.diagnosis.physical.drives import PREFIX, Drives, fitting_of, found_in
from rthm_analysis.diagnosis.physical.formula_model import guess_of, with_all
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.judging import FittedCandidate
from rthm_analysis.diagnosis.search.replacing import is_identified
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.compiled import Floats
from rthm_core.effects.formula import evaluated
from rthm_core.effects.written import MotorFormula
from rthm_core.spec import Spec


def with_formula(
    drives: Drives, begun: Baseline, evidence: Evidence, spec: Spec, first: Floats
) -> Drives | None:
    """The motors with a formula of what no kind is, that leaves nothing but noise of their sensors.

    None where there is nothing of that kind, or only the sensors of the motors show it.

    Parameters
    ----------
    drives : Drives
        As kinds explain them.
    begun : Baseline
        Of the plant that these motors drive.
    evidence : Evidence
        Of the whole recording.
    spec : Spec
        Nominal.
    first : (m,) array
        Command before the test.
    """
    if not drives.left.size or drives_earned(drives.rounds):
        return None
    nominal, alone = Model(spec, prefix=PREFIX), begun.fitting.wires_alone
    if not forces_are_off(alone, (nominal, begun.retuned.model)):
        return None
    motors = Experiment(evidence.first(evidence.trained).only("motor"), first)
    plain = found_in(motors, [], nominal, drives.limits)
    if not forces_follow(alone, nominal, plain.left):
        return None
    fitting = fitting_of(motors, nominal)
    guesses = list(_guesses(motors, plain, motors.predicted(spec, fitting.windows)))
    if not guesses:
        return None
    here = fitting.fit(nominal)
    fitted = fitting.fit(with_all(nominal, guesses), None, DRIVE_STEPS)
    sure = [one for index, one in enumerate(guesses) if is_identified(fitted, index)]
    if sure and len(sure) < len(guesses):
        guesses, fitted = sure, fitting.fit(with_all(nominal, sure), None, DRIVE_STEPS)
    rounds = list(_rounds(guesses, fitted, here))
    return found_in(motors, rounds, fitted.model, drives.limits) if drives_earned(rounds) else None


def _guesses(motors: Experiment, plain: Drives, position: Floats) -> Iterator[InitialGuess]:
    """Terms of what the motors have beside their commands, which give these positions (s, m)."""
    errors, evidence = plain.left * plain.noise, motors.evidence
    taken = np.searchsorted(evidence.due_ns, evidence.stamps_ns, side="right") - 1
    time = np.where(taken < 0, 0.0, evidence.due_ns[taken] * 1e-9)  # what it adds is held with the command
    for k, channel in enumerate(evidence.channels):
        for term in _terms(channel.place, position[:, k], time, errors[:, k], float(plain.noise[k])):
            yield guess_of(term, MotorFormula)


def _rounds(guesses: list[InitialGuess], fitted: Fitted, before: Fitted) -> Iterator[list[FittedCandidate]]:
    """What was added one after the other, first beside nothing at all."""
    for index, one in enumerate(guesses):
        nothing = [] if index else [FittedCandidate.of(one, before)]
        yield [FittedCandidate.of(one, fitted), *nothing]


def _terms(place: str, position: Floats, time: Floats, error: Floats, noise: float) -> tuple[Term, ...]:
    """Terms of an error (s,) over the position or time, whichever foretells more of its last part."""
    known = np.isfinite(error)
    train = known & (np.arange(error.size) < SAMPLED_TRAINED * error.size)
    found: list[tuple[float, tuple[Term, ...]]] = []
    for variable, over in (("u", position), ("t", time)):
        terms = fitted_terms(sampled(variable, over[train], error[train], noise), place)
        left = error - sum((_along(one, variable, over) for one in terms), 0.0)
        before, after = (float(np.mean(np.square(some[known & ~train]))) - noise**2 for some in (error, left))
        found.append((1.0 - after / before if before > 0.0 else 0.0, terms))
    share, terms = max(found, key=lambda one: one[0])
    return terms if share > FORETOLD_SHARE else ()


def _along(term: Term, variable: str, over: Floats) -> Floats:
    return term.size * evaluated(term.factors, term.numbers, **{variable: over})
