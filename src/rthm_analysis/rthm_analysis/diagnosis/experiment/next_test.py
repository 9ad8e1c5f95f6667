"""What to do next, fitting what was found: faults first, then software, then a computed test of the rig."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from rthm_analysis.diagnosis.criteria.experiment import NO_DIFFERENCE, PLAN_SIMULATIONS, SMALLER_SIMULATIONS
from rthm_analysis.diagnosis.experiment.advice import LONGER, REPEAT, SOFTWARE, advice, fault_advice
from rthm_analysis.diagnosis.experiment.contrasts import (
    MOVED,
    Contrast,
    least_known,
    smallest_seen,
    without_weakest,
)
from rthm_analysis.diagnosis.experiment.planning import Hypothesis, Planned, plan_experiment
from rthm_analysis.diagnosis.experiment.repeating import repeated
from rthm_analysis.diagnosis.experiment.sentences import gain_words, listed, what_to_run
from rthm_analysis.diagnosis.numbers import bare, percent, with_unit
from rthm_analysis.diagnosis.result import Fault, Limit, Physics, Retuned, Verdict
from rthm_core.effects import effect
from rthm_core.effects.blocks import family

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.experiment.predicting import Predicted
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


@dataclass(frozen=True)
class Found:
    """What a diagnosis knows when it asks for the next test.

    Attributes
    ----------
    nominal, patched : Spec
        As given, and as found.
    verdict, physics, faults, retuned, limits
        Of the diagnosis.
    rivals : sequence of Hypothesis
        Complete specs that explain the recording as well as `patched`, likeliest first.
    noise : mapping
        Standard deviation of each measured channel, by its name.
    duration : float
        Of the recording, s.
    known : ((s,), (s, n)) arrays or None
        Instants, s, and forces on the plant, N, where the recording knows them and the spec does not.
    """

    nominal: Spec
    patched: Spec
    verdict: Verdict
    physics: Sequence[Physics]
    faults: Sequence[Fault]
    retuned: Mapping[str, Retuned]
    limits: Mapping[str, Limit]
    rivals: Sequence[Hypothesis]
    noise: Mapping[str, float]
    duration: float
    known: tuple[Floats, Floats] | None = None


class Next(NamedTuple):
    """What to do next; the text of a spec and its predicted gain where it is a test of the rig."""

    words: str
    spec: str | None = None
    gain: float | None = None


def next_experiment(found: Found) -> Next:
    """What to do next.

    Returns
    -------
    Next
        The gain is the smallest difference of two predictions, rms in units of the noise.
    """
    if found.faults:
        return Next(fault_advice(found.faults[0].kind, found.faults[0].channel))
    software = [one for one in found.physics if family(one.block) in SOFTWARE]
    if software:
        return Next(_advice(software[0]))
    if found.verdict in ("improved", "unexplained"):
        return _again(found)
    if found.physics:
        return _of_physics(found)
    return _sharper(found) if found.retuned else _smaller(found)


def _advice(one: Physics) -> str:
    name = one.parameters.get("name")
    return advice(one.block, one.kind, one.place, name if isinstance(name, str) else None)


def _lowered(sentence: str) -> str:
    return f"{sentence[:1].lower()}{sentence[1:]}"


def _again(found: Found) -> Next:
    """The same test at another amplitude."""
    again = None if found.known else repeated(found.nominal, found.duration)
    if again is None:
        return Next(REPEAT)
    factor, spec = again
    return Next(
        f"{REPEAT} The spec beside this answer is the test at {bare(factor)} times the amplitude.", spec
    )


def _of_physics(found: Found) -> Next:
    """To tell what was named from its rivals; without any, to confirm the weakest of it."""
    moved = [one for one in found.physics if one.block in MOVED]
    if not moved:
        return Next(_advice(found.physics[0]))
    if found.rivals:
        return _told_apart(found, moved)
    contrast = without_weakest(found.patched, found.physics)
    plan = _plan(found, contrast)
    if contrast is None or plan is None:
        return Next(f"To confirm it: {_lowered(_advice(moved[0]))}")
    return _next(
        found, f"To confirm {contrast.about}", plan, "the predictions of {signal} with and without it"
    )


def _told_apart(found: Found, moved: Sequence[Physics]) -> Next:
    names = [effect(moved[-1].kind, moved[-1].block).called(), *(one.name for one in found.rivals[:2])]
    survivors = [Hypothesis(names[0], found.patched), *found.rivals[:2]]
    plan = plan_experiment(found.nominal, survivors, found.noise, found.duration, known=found.known)
    if plan is None:
        return Next(f"To tell {listed(names)}: {_lowered(_advice(moved[-1]))}")
    who = "the two predictions of {signal}" if len(names) == 2 else "any two of the predictions of {signal}"
    return _next(found, f"To tell {listed(names)}", plan, who)


def _sharper(found: Found) -> Next:
    """To know the least certain parameter better."""
    contrast = least_known(found.patched, found.retuned)
    plan = _plan(found, contrast)
    if contrast is None or plan is None:
        return Next(LONGER)
    left = percent(plan.present / plan.gain)
    words = (
        f"To know {contrast.about} better: {what_to_run(plan, found.nominal)}; "
        f"its standard deviation then falls to about {left} of the present one."
    )
    return Next(words, plan.spec, plan.gain)


def _smaller(found: Found) -> Next:
    """To see smaller effects than this recording would have shown: the kind that gains most."""
    seen = smallest_seen(found.nominal, found.limits)
    without: dict[str, Predicted] = {}
    plans = [
        (_plan(found, contrast, SMALLER_SIMULATIONS // len(seen), without), contrast, limit)
        for contrast, limit in seen
    ]
    planned = [(plan, contrast, limit) for plan, contrast, limit in plans if plan]
    if not planned:
        return Next(LONGER)
    plan, contrast, limit = max(planned, key=lambda one: one[0].gain / max(one[0].present, NO_DIFFERENCE))
    less = limit.value * plan.present / plan.gain
    words = (
        f"To see smaller effects: {what_to_run(plan, found.nominal)}; {contrast.about} then shows from about "
        f"{with_unit(less, limit.unit, 2)} on ({with_unit(limit.value, limit.unit, 2)} in this recording)."
    )
    return Next(words, plan.spec, plan.gain)


def _plan(
    found: Found,
    contrast: Contrast | None,
    budget: int = PLAN_SIMULATIONS,
    seen: dict[str, Predicted] | None = None,
) -> Planned | None:
    if contrast is None:
        return None
    return plan_experiment(
        found.nominal, contrast.pair, found.noise, found.duration, budget, known=found.known, seen=seen
    )


def _next(found: Found, why: str, plan: Planned, who: str) -> Next:
    words = f"{why}: {what_to_run(plan, found.nominal)}; {gain_words(plan, who)}."
    return Next(words, plan.spec, plan.gain)
