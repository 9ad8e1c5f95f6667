"""`plan_experiment`: the input that tells hypotheses apart best, found by predicting what each would do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rthm_analysis.diagnosis.criteria.experiment import (
    PLAN_GAIN_RATIO,
    PLAN_MOST_HYPOTHESES,
    PLAN_SIMULATIONS,
)
from rthm_analysis.diagnosis.experiment.response import Response
from rthm_analysis.diagnosis.experiment.searching import Search
from rthm_analysis.diagnosis.experiment.trials import SIDES, Trial
from rthm_core.errors import InputError
from rthm_core.spec import write_spec

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.experiment.predicting import Predicted
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


@dataclass(frozen=True)
class Hypothesis:
    """What the rig may be: a complete spec, and its name within a sentence."""

    name: str
    spec: Spec


@dataclass(frozen=True)
class Planned:
    """The test to run next.

    Attributes
    ----------
    spec : str
        Text of the nominal spec with another load or initial motion.
    gain : float
        Smallest rms difference between two predictions, in units of the noise.
    present : float
        The same in the present test.
    signal : str
        Channel in which that difference shows most.
    trial : Trial
    duration : float
        s.
    """

    spec: str
    gain: float
    present: float
    signal: str
    trial: Trial
    duration: float


def plan_experiment(
    nominal: Spec,
    survivors: Sequence[Hypothesis],
    noise: Mapping[str, float],
    duration: float,
    budget: int = PLAN_SIMULATIONS,
    known: tuple[Floats, Floats] | None = None,
    seen: dict[str, Predicted] | None = None,
) -> Planned | None:
    """Find the input whose predictions by the surviving hypotheses differ most.

    Parameters
    ----------
    nominal : Spec
        Whose loads and initial motion are changed.
    survivors : sequence of Hypothesis
        At least two, the likeliest first; those beyond the third are left out.
    noise : mapping
        Standard deviation of the noise of each measured channel by its name (``x1``, ``v1``, ``F``), in its
        unit.
    duration : float
        Of the present test, s; the planned one is as long, or as long as its predictions may be.
    budget : int
        Simulations that may be made.
    known : ((s,), (s, n)) arrays, optional
        Instants, s, and forces on the plant, N, that the recording knows and the spec does not.
    seen : dict, optional
        What the first hypothesis does in trials, for other plans of which it is the first as well.

    Returns
    -------
    Planned or None
        None where a hypothesis is unstable, nothing moves, or no input within the bounds tells clearly more
        than the present test.

    Examples
    --------
    >>> rough = Hypothesis("Stribeck friction", read_spec("patched.yaml"))
    >>> plan = plan_experiment(nominal, [Hypothesis("dry friction", dry), rough], {"x1": 1e-4}, 60.0)
    >>> print(plan.gain)
    14.2
    """
    specs = [one.spec for one in survivors[:PLAN_MOST_HYPOTHESES]]
    if len(specs) < 2 or any(Response(one).unstable for one in specs):
        return None
    try:
        present = Trial({}, 1.0, known) if known else present_trial(nominal)
        search = Search(nominal, specs, noise, duration, budget, seen)
        found = search.best(present)
    except InputError:  # a load that comes from a file which is not here
        return None
    if found is None or not found[0].apart > PLAN_GAIN_RATIO * found[1]:
        return None
    told, before = found
    text = write_spec(told.trial.changed(nominal))
    return Planned(text, told.apart, before, told.signal, told.trial, search.duration)


def present_trial(nominal: Spec) -> Trial:
    """The test as the nominal spec has it."""
    sides = {side: getattr(nominal.load, side) for side in SIDES}
    return Trial({side: one for side, one in sides.items() if one is not None}, 1.0)
