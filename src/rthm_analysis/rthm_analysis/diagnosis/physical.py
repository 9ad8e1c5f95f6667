"""Diagnose the physical side: first the motors on their own, then wires, plant and sensors jointly.

Every block could be looked at alone, but one wrong block shows in several. So all measured channels are
simulated from the commands, and the smallest addition that explains them all at once is looked for.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.choosing import FINISHING, Choice, choose, doubt
from rthm_analysis.diagnosis.drives import Drives, choose_drives
from rthm_analysis.diagnosis.evidence import Evidence
from rthm_analysis.diagnosis.experiment import Experiment
from rthm_analysis.diagnosis.fitting import FINE, WRONG, Fitted, Fitting
from rthm_analysis.diagnosis.limits import Limits
from rthm_analysis.diagnosis.model import Model, uncertain
from rthm_analysis.diagnosis.noise import noise_level
from rthm_analysis.diagnosis.refining import Tried
from rthm_analysis.diagnosis.windows import Windows, windows
from rthm_core.compiled import Floats
from rthm_core.spec import Spec

TRAIN = 2.0 / 3.0
"""Part of a recording from its start that fits and choices may see."""

LOST = 5.0
"""Squared error per sample, in units of the noise, of the best single effect in a run over everything, from
which effects are looked for in short runs."""

NEAR = 10.0
"""Squared error per sample, in units of the noise, from which longer windows would only drift further."""


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
    experiment, part = Experiment(seen, first), Experiment(seen.first(train), first)
    settled = drives.model
    runs, sigma, fitting, nominal = _started(seen, settled, train, part, progress)
    experiment.begin_at(seen.stamps_ns[runs.start])
    retuned = _retuned(fitting, nominal)
    lost = LOST if runs.length is None else np.inf
    short = None
    if fitting.doubt > lost:
        progress("looking in short runs, where a wrong model stays near")
        short = _short(seen, settled, train, part, sigma, progress)
        retuned = _begun_near(fitting, retuned, short.retuned)
    choice = choose(fitting, retuned, lambda left: left > lost)
    if short is not None and fitting.doubt > lost:
        choice, there = _led_by(short, fitting, retuned, choice)
        if there:
            runs, fitting, nominal = short.runs, short.fitting, short.nominal
    experiment.sharp = part.sharp
    return Physical(
        spec, seen, train, experiment, runs, sigma, drives.rounds, drives.settled, fitting, nominal, choice,
        drives.limits,
    )  # fmt: skip


class Short(NamedTuple):
    """Short runs, in which a model that is wrong does not get far from the recording.

    Attributes
    ----------
    runs : Windows
    fitting : Fitting
    nominal, retuned : Fitted
        There.
    """

    runs: Windows
    fitting: Fitting
    nominal: Fitted
    retuned: Fitted


def _short(
    seen: Evidence,
    settled: Model,
    train: int,
    part: Experiment,
    sigma: Floats,
    progress: Callable[[str], None],
) -> Short:
    runs = windows(seen, settled.spec, seen.driven_by == "command", short=True)
    fitting = Fitting(part, runs.first(train), sigma, settled, progress)
    nominal = fitting.fit(settled)
    return Short(runs, fitting, nominal, _retuned(fitting, nominal))


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


def _led_by(short: Short, fitting: Fitting, retuned: Fitted, choice: Choice) -> tuple[Choice, bool]:
    """Go on with a choice that was lost, led by what short runs show.

    Returns
    -------
    Choice
    bool
        Whether the choice was left to the short runs.
    """
    closer, near = short.fitting, short.retuned
    again = choose(closer, near, lambda left: left < WRONG)
    if closer.doubt >= WRONG:
        return choose(fitting, retuned, begun=choice), False
    whole = _over_the_whole(fitting, again.best.model)
    if whole is not None and doubt(fitting, whole) < WRONG:
        fitting.doubt = doubt(fitting, whole)
        begun = Choice(retuned, whole, again.rounds, choice.limits)
        return choose(fitting, retuned, begun=begun), False
    return choose(closer, near, begun=again), True


def _retuned(fitting: Fitting, nominal: Fitted) -> Fitted:
    """Fit of what the spec calls uncertain, the data counting the less the further they stay away."""
    fitting.progress("retuning what is uncertain")
    fitting.doubt = doubt(fitting, nominal)
    model = nominal.model
    retuned = fitting.fit(replace(model, parameters=(*model.parameters, *uncertain(model.nominal))))
    if fitting.doubt > 1.5:
        fitting.doubt = doubt(fitting, retuned)
        retuned = fitting.fit(retuned.model)
    return retuned


def _started(
    seen: Evidence, settled: Model, train: int, part: Experiment, progress: Callable[[str], None]
) -> tuple[Windows, Floats, Fitting, Fitted]:
    """Free runs as long as the nominal model stays near the recording, and what it leaves there."""
    longer = 1.0
    while True:
        runs = windows(seen, settled.spec, seen.driven_by == "command", longer)
        part.begin_at(seen.stamps_ns[runs.first(train).start])
        sigma = _noise(part, settled.spec, runs.first(train))
        fitting = Fitting(part, runs.first(train), sigma, settled, progress)
        nominal = fitting.fit(settled)
        enough = runs.length is None or runs.length > 0.08 * float(seen.time[-1])
        if enough or doubt(fitting, nominal) > NEAR:
            return runs, sigma, fitting, nominal
        longer *= 2.0


def _noise(experiment: Experiment, spec: Spec, runs: Windows) -> Floats:
    measured = experiment.evidence.measured
    residual = measured - experiment.predicted(spec, runs)
    return np.array([noise_level(r, y) for r, y in zip(residual.T, measured.T, strict=True)])
