"""Diagnose the physical side: first the motors on their own, then wires, plant and sensors jointly.

Every block could be looked at alone, but one wrong block shows in several. So all measured channels are
simulated from the commands, and the smallest addition that explains them all at once is looked for.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rthm_analysis.diagnosis.fitting.fitting import FINE, WRONG, Fitted, Fitting
from rthm_analysis.diagnosis.fitting.limits import Limits
from rthm_analysis.diagnosis.physical.beginning import (
    Begun,
    begin,
    choose_again,
    noise_left,
    retuned_from,
)
from rthm_analysis.diagnosis.physical.drives import Drives, choose_drives
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.windows import Windows, windows
from rthm_analysis.diagnosis.search.choosing import choose
from rthm_analysis.diagnosis.search.judging import Choice, Tried, doubt
from rthm_analysis.diagnosis.search.refining import FINISHING
from rthm_core.compiled import Floats
from rthm_core.spec import Spec

TRAIN = 2.0 / 3.0
"""Part of a recording from its start that fits and choices may see."""

LOST = 5.0
"""Squared error per sample, in units of the noise, of the best single effect in a run over everything, from
which effects are looked for in short runs."""


@dataclass(frozen=True)
class Physical:
    """What was found in the physical side, before it is put into words.

    Attributes
    ----------
    spec : Spec
        Nominal.
    evidence : Evidence
        All of it; `train` is the number of samples that fits have seen.
    experiment : Experiment
        Over the whole recording.
    windows : Windows
    sigma : (k,) array
        Noise of the channels.
    drives : list of Tried
        Effects found in the motors, with the other kinds that were tried behind each.
    settled : Spec
        With the motors' effects.
    nominal : Fitted
        The settled spec as it stands.
    choice : Choice
        Retuned model, and what was added to it.
    drive_limits : dict
        Sizes at which other effects of the motors would have been seen.
    """

    spec: Spec
    evidence: Evidence
    train: int
    experiment: Experiment
    windows: Windows
    sigma: Floats
    drives: list[list[Tried]]
    settled: Spec
    fitting: Fitting
    nominal: Fitted
    choice: Choice
    drive_limits: Limits


@np.errstate(over="ignore", invalid="ignore")  # a model that diverges is known by its error
def diagnose_physical(
    evidence: Evidence, spec: Spec, before: Floats, progress: Callable[[str], None]
) -> Physical:
    """Find what the spec leaves out of motors, wires, plant and sensors.

    Parameters
    ----------
    evidence : Evidence
    spec : Spec
    before : (m,) array
        Command that had been there for ever before the test, m.
    progress : callable
        Told what is being done, in words.
    """
    train = int(TRAIN * evidence.stamps_ns.size)
    first = before if evidence.driven_by == "command" else np.empty(0)
    drives = Drives([], spec, {})
    if evidence.only("motor").channels:
        progress("checking the motors")
        drives = choose_drives(evidence.first(train).only("motor"), spec, first)
    seen = evidence.only("position", "velocity", "force")
    settled = drives.model
    begun, *others = begin(seen, settled, first, train, progress)
    begun, choice = _chosen(begun, seen, settled, train)
    begun, choice = choose_again(begun, others, choice)
    part = begun.fitting.experiment
    sigma = np.minimum(begun.sigma, noise_left(part, choice.best.model.spec, begun.fitting.windows))
    experiment = Experiment(seen, first, between=part.between, sharp=part.sharp)
    experiment.begin_at(seen.stamps_ns[begun.runs.start])
    return Physical(
        spec, seen, train, experiment, begun.runs, sigma, drives.rounds, drives.settled, begun.fitting,
        begun.nominal, choice, drives.limits,
    )  # fmt: skip


def _chosen(begun: Begun, seen: Evidence, settled: Model, train: int) -> tuple[Begun, Choice]:
    """Effects that explain what is left, and the runs in which they were found: short ones if need be."""
    fitting = begun.fitting
    lost = LOST if begun.runs.length is None else np.inf
    short = None
    if fitting.doubt > lost:
        fitting.progress("looking in short runs, where a wrong model stays near")
        short = _short(begun, seen, settled, train)
        begun = begun._replace(retuned=_begun_near(fitting, begun.retuned, short.retuned))
    choice = choose(fitting, begun.retuned, lambda left: left > lost)
    if short is None or fitting.doubt <= lost:
        return begun, choice
    return _led_by(short, begun, choice)


def _short(begun: Begun, seen: Evidence, settled: Model, train: int) -> Begun:
    """The same in short runs, in which a model that is wrong does not get far from the recording."""
    longer = begun.fitting
    runs = windows(seen, settled.spec, seen.driven_by == "command", short=True)
    fitting = Fitting(longer.experiment, runs.first(train), begun.sigma, settled, longer.progress)
    nominal = fitting.fit(settled)
    return Begun(runs, begun.sigma, fitting, nominal, retuned_from(fitting, nominal))


def _begun_near(fitting: Fitting, retuned: Fitted, near: Fitted) -> Fitted:
    """Retuned model of the whole recording, or what a fit reaches from that of short runs if it is better.

    Over many periods a wrong frequency is out of step, and a fit ends where it is in step by chance.
    """
    again = _over_the_whole(fitting, near.model)
    if again is None:
        return retuned
    best = min(retuned, again, key=lambda fitted: doubt(fitting, fitted))
    fitting.doubt = doubt(fitting, best)
    return best


def _over_the_whole(fitting: Fitting, model: Model) -> Fitted | None:
    """Fit over the whole recording of what was found in short runs; None where it diverges."""
    try:
        return fitting.fit(model, most=FINISHING, least=FINE)
    except np.linalg.LinAlgError:
        return None


def _led_by(short: Begun, begun: Begun, choice: Choice) -> tuple[Begun, Choice]:
    """Go on with a choice that was lost, led by what short runs show; in them, where only they can tell."""
    fitting, closer, near = begun.fitting, short.fitting, short.retuned
    again = choose(closer, near, lambda left: left < WRONG)
    if closer.doubt >= WRONG:
        return begun, choose(fitting, begun.retuned, begun=choice)
    whole = _over_the_whole(fitting, again.best.model)
    if whole is not None and doubt(fitting, whole) < WRONG:
        fitting.doubt = doubt(fitting, whole)
        led = Choice(begun.retuned, whole, again.rounds, choice.limits)
        return begun, choose(fitting, begun.retuned, begun=led)
    return short, choose(closer, near, begun=again)
