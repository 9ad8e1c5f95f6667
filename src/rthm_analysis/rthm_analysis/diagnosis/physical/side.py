"""Diagnose the physical side: first the motors on their own, then wires, plant and sensors jointly.

Every block could be looked at alone, but one wrong block shows in several. So all measured channels are
simulated from the commands, and the smallest addition that explains them all at once is looked for.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rthm_analysis.diagnosis.criteria.noise import UNTOUCHED_SHARE
from rthm_analysis.diagnosis.criteria.replay import SECOND_QUESTION_STEPS
from rthm_analysis.diagnosis.criteria.verdict import NOISE_REVISED_RATIO
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.fitting.limits import Limits
from rthm_analysis.diagnosis.fitting.noise import Noise
from rthm_analysis.diagnosis.missing.motion import Along, along
from rthm_analysis.diagnosis.missing.sites import site_of
from rthm_analysis.diagnosis.physical.beginning import Baseline, begin, choose_again, noise_of, with_noise
from rthm_analysis.diagnosis.physical.colours import coloured, left_by
from rthm_analysis.diagnosis.physical.drives import Drives, choose_drives
from rthm_analysis.diagnosis.physical.explaining import chosen, fitted_again, going_on, is_behind
from rthm_analysis.diagnosis.physical.filtered_noise import with_filtered_noise
from rthm_analysis.diagnosis.physical.foreseeing import foreseen
from rthm_analysis.diagnosis.physical.leaves_noise import at_noise
from rthm_analysis.diagnosis.physical.motor_composing import with_formula
from rthm_analysis.diagnosis.physical.whitening import whitened
from rthm_analysis.diagnosis.physical.zeros import OwnZeros
from rthm_analysis.diagnosis.replay.budget import budget_for
from rthm_analysis.diagnosis.replay.evidence import MOTION, Evidence
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_analysis.diagnosis.search.judging import FittedCandidate, Selection
from rthm_core.compiled import Flags, Floats
from rthm_core.spec import Spec


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
    noise : Noise
        Of the channels.
    drives : list of FittedCandidate
        Effects found in the motors, with the other kinds that were tried behind each.
    settled : Spec
        With the motors' effects.
    nominal : Fitted
        The settled spec as it stands.
    selection : Selection
        Retuned model, and what was added to it.
    drive_limits : dict
        Sizes at which other effects of the motors would have been seen.
    motor_left : (s, m) array
        What the settled spec leaves of the motors' positions in the training part, over their noise.
    motor_noise : (m,) array
        Of the motors' sensors, m.
    motor_wanders : bool
        Whether that may be coloured noise of their sensors.
    own_zeros : OwnZeros or None
        What was taken out of each of several recordings before.
    """

    spec: Spec
    evidence: Evidence
    train: int
    experiment: Experiment
    windows: Windows
    noise: Noise
    drives: list[list[FittedCandidate]]
    settled: Spec
    fitting: Fitting
    nominal: Fitted
    selection: Selection
    drive_limits: Limits
    motor_left: Floats
    motor_noise: Floats
    motor_wanders: bool
    own_zeros: OwnZeros | None = None

    def along(self, place: str) -> Along:
        """Motion at a place of the plant along the recording, with the rates of the best model."""
        spec = self.selection.best.model.spec
        return along(self.evidence, self.experiment.motion(spec, self.windows), site_of(spec, place))

    @property
    def sigma(self) -> Floats:
        """Standard deviations (k,) of the noise of the channels as a whole."""
        return self.noise.level


@np.errstate(over="ignore", invalid="ignore")  # a model that diverges is known by its error
def diagnose_physical(
    evidence: Evidence, spec: Spec, before: Floats, progress: Callable[[str], None], *, formula: bool = True
) -> Physical:
    """Find what the spec leaves out of motors, wires, plant and sensors.

    Parameters
    ----------
    evidence : Evidence
    spec : Spec
    before : (m,) array
        Command in steady state before the test, m.
    progress : callable
        Told what is being done, in words.
    formula : bool
        Whether a formula may be enough, where no kind is.
    """
    train = evidence.trained
    first = before if evidence.driven_by == "command" else np.empty(0)
    drives = Drives([], spec, {}, np.empty((train, 0)), np.empty(0), wanders=False)
    if evidence.only("motor").channels:
        progress("checking the motors")
        drives = choose_drives(evidence.first(train).only("motor"), spec, first)
    seen = evidence.only(*MOTION, "force")
    settled = drives.model
    budget = budget_for(seen.stamps_ns.size)
    if not formula:
        budget.lose()
    begun, *others = whitened(begin(seen, settled, first, budget, progress))
    if (more := with_formula(drives, begun, evidence, spec, first)) is not None:
        drives, settled = more, more.model
        begun, *others = whitened(begin(seen, settled, first, budget, progress))
    plain = _of_plain_kinds(begun, seen, settled, train) if seen.ends_at_rest else None
    if seen.ends_at_rest and plain is None:
        budget.allow(SECOND_QUESTION_STEPS)
        begun, *others = whitened(begin(seen, settled, first, budget, progress))
    wanted = formula and not seen.comes_to_rest
    begun, selection = plain or chosen(begun, seen, settled, train, formula=wanted)
    begun, selection = choose_again(begun, others, selection)
    if (filtered := with_filtered_noise(begun, selection)) is not None:
        (begun, selection), noise = filtered, filtered[0].noise
    else:
        begun, selection, noise = _by_noise_left(begun, selection, seen, settled)
    experiment = _over_everything(begun, seen, first)
    begun, selection = foreseen(begun, selection, seen, settled, experiment)
    experiment.begin_at(seen.stamps_ns[begun.runs.start])
    return Physical(
        spec, seen, train, experiment, begun.runs, noise, drives.rounds, drives.settled, begun.fitting,
        begun.nominal, selection, drives.limits, drives.left, drives.noise, drives.wanders,
    )  # fmt: skip


def _by_noise_left(
    begun: Baseline, selection: Selection, seen: Evidence, settled: Model
) -> tuple[Baseline, Selection, Noise]:
    """The same, judged by the noise that shows once physics is known, and that noise."""
    noise = _noise_left(begun, selection)
    if np.any(noise.level < NOISE_REVISED_RATIO * begun.noise.level):
        quieter = with_noise(begun, noise)
        again: tuple[Baseline, Selection] | None
        if begun.fitting.budget.spent or selection.formulas:
            again = fitted_again(quieter, selection)
        else:
            again = going_on(quieter, selection) or chosen(
                quieter, seen, settled, seen.trained, formula=False
            )
            again = None if is_behind(again, selection) else again
        if again is not None:
            begun, selection = again
            noise = _noise_left(begun, selection)
    return begun, selection, noise


def _of_plain_kinds(
    begun: Baseline, seen: Evidence, settled: Model, train: int
) -> tuple[Baseline, Selection] | None:
    """What kinds that can imitate no others explain, if that is all but noise: friction, which ends most
    motions at rest, is one of them.
    """
    with begun.fitting.simple_only():
        there, selection = chosen(begun, seen, settled, train, formula=False)
    return (there, selection) if at_noise(there.fitting, selection.best) else None


def _over_everything(begun: Baseline, seen: Evidence, first: Floats) -> Experiment:
    """Simulations of the whole recording, as exact as those of its first part."""
    part = begun.fitting.experiment
    experiment = Experiment(seen, first, between=part.between, sharp=part.sharp, seen=seen.trained)
    experiment.begin_at(seen.stamps_ns[begun.runs.start])
    return experiment


def _noise_left(begun: Baseline, selection: Selection) -> Noise:
    """Noise that shows once physics is known: never more than what was weighed by."""
    fitting, best = begun.fitting, selection.best
    white = noise_of(fitting, best)
    if begun.noise.is_white and not selection.rounds:  # its colour was asked for before the search
        return begun.noise.smaller(white)
    left = coloured(fitting, best, white, named=bool(selection.rounds))
    smaller = begun.noise.smaller(left.not_shared(white))
    return begun.noise.kept(_untouched(fitting, selection), smaller)


def _untouched(fitting: Fitting, selection: Selection) -> Flags:
    """Of each channel whether the effects of a selection leave as much of it as there was without them."""
    before, after = (
        np.nansum(np.square(left_by(fitting, one)), axis=0) for one in (selection.base, selection.best)
    )
    return np.asarray(after > (1.0 - UNTOUCHED_SHARE) * before)
