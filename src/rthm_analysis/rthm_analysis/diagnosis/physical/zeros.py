"""Zeros that differ from recording to recording: of sensors, or of what is known of the forces.

Each recording of one rig has its own, as it has a state of its own in which it begins: what differs from day
to day is no physics.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.search import NEAR_NOISE_CHI2
from rthm_analysis.diagnosis.criteria.zeros import (
    ZERO_ROUNDS,
    ZERO_SEEN_SHARE,
    ZERO_STDS,
    ZERO_TRIAL_SHARE,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitting
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.windows import windows
from rthm_core.compiled import Floats
from rthm_core.spec import Spec

LOAD = "load"
"""Family of the known force on a dof, as of a channel."""


class Zeros(NamedTuple):
    """Zeros of some signals in each of r recordings.

    Attributes
    ----------
    targets : tuple of c Channel
        Measured signals, or known forces of the family `LOAD`.
    values, stds : (r, c) arrays
        What each reads at a true value of zero; NaN and infinity where states in which runs begin stand for
        it.
    left, shared, expected : float
        Squared error, in units of the noise, with a zero for each recording, with one for all of them, and of
        noise alone.
    """

    targets: tuple[Channel, ...]
    values: Floats
    stds: Floats
    left: float
    shared: float
    expected: float

    @property
    def of_forces(self) -> bool:
        """Whether they are those of what is known of the forces."""
        return self.targets[0].family == LOAD

    @property
    def are_enough(self) -> bool:
        """Whether the model leaves next to nothing but noise behind them."""
        return self.left < NEAR_NOISE_CHI2 * self.expected

    @property
    def differing(self) -> tuple[Channel, ...]:
        """Those whose zero differs from recording to recording."""
        apart = np.abs(self.values - self.values.mean(axis=0)) > ZERO_STDS * self.stds
        return tuple(one for one, some in zip(self.targets, apart.any(axis=0), strict=True) if some)

    def taken_from(self, evidence: Evidence, dofs: tuple[str, ...]) -> Evidence:
        """Recordings of a plant with some dofs as they would be with right zeros; what is left of those of
        sensors does not count.
        """
        measured, load = evidence.measured.copy(), evidence.load.copy()
        for one, column in zip(self.targets, self.values.T, strict=True):
            forced = one.family == LOAD
            signal = load[:, dofs.index(one.place)] if forced else measured[:, evidence.channels.index(one)]
            for samples, value in zip(evidence.recordings, column, strict=True):
                signal[samples] -= value
        own = tuple(one for one in self.targets if one.family != LOAD)
        return replace(evidence, measured=measured, load=load, own_zero=own)


class OwnZeros(NamedTuple):
    """Zeros that differ from recording to recording, and others that the recordings do not tell from them."""

    zeros: Zeros
    rival: Zeros | None = None


class Rig(NamedTuple):
    """What several recordings are compared with: a model, the command before them, and the noise (k,)."""

    spec: Spec
    first: Floats
    sigma: Floats


def zeros_of(evidence: Evidence, rig: Rig, targets: Sequence[Channel]) -> Zeros | None:
    """Zeros of some signals in each recording that fit best; None where the model diverges."""
    nothing = np.zeros((len(evidence.begins), len(targets)))
    found = Zeros(tuple(targets), nothing, nothing, np.inf, np.inf, 0.0)
    for _ in range(ZERO_ROUNDS):
        step = _step(
            replace(found.taken_from(evidence, rig.spec.plant.dofs), own_zero=()), rig, found.targets
        )
        if step is None:
            return None
        shared = step.shared if found.left == np.inf else found.shared
        found = step._replace(values=found.values + step.values, shared=shared)
    return found


def _step(evidence: Evidence, rig: Rig, targets: tuple[Channel, ...]) -> Zeros | None:
    """One step towards the zeros, and what is left behind it."""
    model = Model(rig.spec)
    runs = windows(evidence, rig.spec, evidence.driven_by == "command")
    experiment = Experiment(evidence, rig.first, evidence.stamps_ns[runs.start])
    fitting = Fitting(experiment, runs, rig.sigma, model)
    residual = fitting.residual(model)
    whole = np.stack([_response(fitting, residual, rig, one) for one in targets])
    if not (np.isfinite(residual).all() and np.isfinite(whole).all()):
        return None
    left, columns = fitting.projected(residual), fitting.projected(whole)
    width, each = fitting.channels, []
    for one in evidence.recordings:
        rows = slice(one.start * width, one.stop * width)
        each.append(_solved(left[rows], columns[:, rows], whole[:, rows]))
    shared = _solved(left, columns, whole)[2]
    values, stds, squares = (np.array(some) for some in zip(*each, strict=True))
    return Zeros(targets, values, stds, float(squares.sum()), shared, fitting.expected)


def _response(fitting: Fitting, residual: Floats, rig: Rig, target: Channel) -> Floats:
    """Change of all that is measured (s k,), over the noise, with a zero that is one unit higher in all
    recordings.
    """
    experiment = fitting.experiment
    evidence = experiment.evidence
    if target.family != LOAD:
        column = np.zeros_like(evidence.measured)
        column[:, evidence.channels.index(target)] = 1.0
        return (column * fitting.weight).ravel()
    size = _trial(evidence, rig.spec, target.place)
    load = evidence.load.copy()
    load[:, rig.spec.plant.dofs.index(target.place)] -= size
    pushed = Experiment(replace(evidence, load=load), rig.first, experiment.starts_ns)
    predicted = pushed.predicted(rig.spec, fitting.windows)
    return np.asarray((fitting.errors(predicted) - residual) / -size)


def _trial(evidence: Evidence, spec: Spec, dof: str) -> float:
    """A small force on a dof, N."""
    n, place = spec.plant.n, spec.plant.dofs.index(dof)
    stiffness = abs(spec.plant.stiffness[place * n + place]) or 1.0
    moved = [k for k, one in enumerate(evidence.channels) if one.place == dof and one.family == "position"]
    spread = float(np.nanstd(evidence.measured[:, moved[0]])) if moved else 1.0
    return ZERO_TRIAL_SHARE * stiffness * (spread or 1.0)


def _solved(left: Floats, columns: Floats, whole: Floats) -> tuple[Floats, Floats, float]:
    """Zeros (c,) that leave least of some errors, their standard deviations (c,), and what is left.

    Columns (c, rows) are `whole` without what states can explain.
    """
    kept = np.square(columns).sum(axis=1) > ZERO_SEEN_SHARE * np.square(whole).sum(axis=1)
    values, stds = np.zeros(kept.size), np.full(kept.size, np.inf)
    some = columns[kept]
    values[kept] = np.linalg.lstsq(some.T, left, rcond=None)[0]
    squares = float(np.square(left - values @ columns).sum())
    spread = max(1.0, squares / max(int(np.count_nonzero(left)), 1))
    stds[kept] = np.sqrt(spread * np.diag(np.linalg.pinv(some @ some.T)))
    return values, stds, squares
