"""The same test at another amplitude: what to run where nothing that is known explains the difference."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.experiment import (
    PREDICTED_MOST_STEPS,
    REPEATED_AMPLITUDES,
    REPEATED_BOUNDS_RATIO,
)
from rthm_analysis.diagnosis.experiment.bounds import bounds_of
from rthm_analysis.diagnosis.experiment.planning import present_trial
from rthm_analysis.diagnosis.experiment.predicting import Predictor, step_of
from rthm_core.errors import InputError
from rthm_core.spec import FileLoad, write_spec

if TYPE_CHECKING:
    from rthm_core.spec import Spec


def repeated(nominal: Spec, duration: float) -> tuple[float, str] | None:
    """Factor and spec of the same test at twice the amplitude, or at half where that is too much.

    None where the spec does not say what moved the rig, or neither is within the limits.
    """
    present = present_trial(nominal)
    if any(isinstance(one, FileLoad) for one in present.loads.values()) or not _moves(nominal):
        return None
    step = step_of(nominal)
    predictor = Predictor(nominal, step, min(int(np.ceil(duration / step)), PREDICTED_MOST_STEPS))
    try:
        bounds = bounds_of(nominal, present, predictor.predict(present))
    except InputError:
        return None
    for factor in REPEATED_AMPLITUDES:
        trial = present.scaled(factor)
        if bounds.used(predictor.predict(trial)) <= REPEATED_BOUNDS_RATIO:
            return factor, write_spec(trial.changed(nominal))
    return None


def _moves(nominal: Spec) -> bool:
    plant = nominal.plant
    loads = (nominal.load.plant, nominal.load.numerical)
    listed = any(one is not None and one.kind != "none" for one in loads)
    return listed or plant is None or any([*plant.initial_position, *plant.initial_velocity])
