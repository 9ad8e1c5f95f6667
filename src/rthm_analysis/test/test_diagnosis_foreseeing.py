"""A motion that parts from its neighbours is told in short runs: a free run over unseen data says nothing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
import pytest

from rthm_analysis.diagnosis.fitting.noise import white_noise
from rthm_analysis.diagnosis.physical.beginning import Baseline
from rthm_analysis.diagnosis.physical.foreseeing import foreseen
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_analysis.diagnosis.search.judging import FittedCandidate, Selection
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.compiled import Floats
from rthm_core.spec import Spec

from .fittings import SIGMA, fitting_of
from .side import PAPER, having

FORCE = 0.3


@dataclass
class Ahead:
    """Predictions twice as long as what was seen, which depend on the friction by some newtons per newton."""

    samples: int
    slope: float

    def predicted(self, spec: Spec, runs: Windows) -> Floats:
        (friction,) = spec.effects
        size = cast("float", friction.parameters["force"]) - FORCE
        return np.full((2 * self.samples, SIGMA.size), self.slope * size) * SIGMA


@pytest.mark.parametrize(("slope", "in_one_run"), [(1.0, True), (1e6, False)])
def test_what_cannot_be_told_in_one_run_is_judged_in_short_ones(slope: float, in_one_run: bool) -> None:
    fitting = fitting_of(having("plant", "coulomb_friction", force=FORCE), 7)
    base = fitting.fit(Model(PAPER))
    begun = Baseline(fitting.windows, white_noise(SIGMA), fitting, base, base)
    friction = EffectInstance("plant", "coulomb_friction", "x1", {"force": FORCE})
    start = InitialGuess(friction, ("force",), ("force",), {"force": FORCE})
    best = fitting.fit(start.added_to(base.model))
    selection = Selection(base, best, [[FittedCandidate(start, best, best.squares)]])
    seen = fitting.experiment.evidence
    ahead = cast("Experiment", Ahead(seen.stamps_ns.size, slope))
    then, found = foreseen(begun, selection, seen, base.model, ahead)
    assert (then is begun) == (found is selection) == in_one_run == (then.runs.length is None)
    assert abs(found.best.model.effect_values(0)["force"] - FORCE) < 0.01
