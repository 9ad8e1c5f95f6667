"""When a force acts that does not act all the time: where short runs leave more than noise.

A run over everything goes on being off when the force has ended. In short runs each begins anew, so that
those before the force and those behind it leave noise.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.verdict import (
    ACTING_FEWEST_QUIET,
    ACTING_RUN_RATIOS,
    ACTING_STDS,
    LARGEST_INTERVAL_SHARE,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitting
from rthm_analysis.diagnosis.missing.curves import Regression
from rthm_analysis.diagnosis.missing.formulas import without_needless_end
from rthm_analysis.diagnosis.missing.terms import Term
from rthm_analysis.diagnosis.missing.within import acting_within
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.windows import Windows, windows
from rthm_core.compiled import Flags, Floats


class Acting(NamedTuple):
    """A model beside which a force acts in an interval alone, s."""

    model: Model
    interval: tuple[float, float]


def acting(physical: Physical, samples: int) -> Acting | None:
    """When a force acts in the first samples, beside the nominal or the retuned model; None where it does
    throughout, or where nobody can tell.
    """
    found = [
        Acting(model, one) for model in _models(physical) for one in _intervals(physical, model, samples)
    ]
    return min(found, key=lambda one: one.interval[1] - one.interval[0], default=None)


def acting_terms(physical: Physical, found: Acting, samples: int) -> tuple[Regression, tuple[Term, ...]]:
    """Terms of a force in its interval, from short runs of the first samples, and what they explain there;
    without an end where that explains as much.
    """
    runs = _runs(physical, found.model, samples, 1.0)
    regression = Regression(_experiment(physical, samples), runs, physical.noise, found.model, samples)
    return regression, without_needless_end(regression, acting_within(regression, found.interval))


def _models(physical: Physical) -> Iterator[Model]:
    yield physical.nominal.model
    if physical.selection.base.model.parameters != physical.nominal.model.parameters:
        yield physical.selection.base.model


def _experiment(physical: Physical, samples: int) -> Experiment:
    whole = samples == physical.evidence.time.size
    return physical.experiment if whole else physical.fitting.experiment


def _runs(physical: Physical, model: Model, samples: int, longer: float) -> Windows:
    seen = physical.evidence
    return windows(seen, model.spec, seen.driven_by == "command", longer, short=True).first(samples)


def _intervals(physical: Physical, model: Model, samples: int) -> Iterator[tuple[float, float]]:
    """What the shortest runs say that say anything."""
    time, noise = physical.evidence.time[:samples], physical.noise
    for longer in ACTING_RUN_RATIOS:
        runs = _runs(physical, model, samples, longer)
        fitting = Fitting(_experiment(physical, samples), runs, noise.sigma, model, colours=noise.colours)
        loud = np.flatnonzero(_is_loud(fitting, fitting.projected(fitting.residual(model))))
        if not loud.size:
            continue
        edges = np.append(runs.start, samples - 1)
        begin, end = int(edges[loud[0]]), int(edges[loud[-1] + 1])
        quiet = runs.start.size - (loud[-1] + 1 - loud[0])
        if quiet >= ACTING_FEWEST_QUIET and end - begin < LARGEST_INTERVAL_SHARE * samples:
            yield float(time[begin]), float(time[end])
        return


def _is_loud(fitting: Fitting, left: Floats) -> Flags:
    """Of each run whether it leaves more than noise (left: (s k,), over the noise)."""
    run = np.repeat(fitting.windows.of(fitting.measured.shape[0]), fitting.channels)
    count = np.bincount(run, fitting.weight.ravel() > 0.0)
    squares = np.bincount(run, np.square(left))
    free = np.maximum(count - fitting.windows.state.shape[1], 1.0)
    return np.asarray(squares > free + ACTING_STDS * np.sqrt(2.0 * free))
