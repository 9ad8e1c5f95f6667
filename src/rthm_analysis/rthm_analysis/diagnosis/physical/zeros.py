"""Zeros that differ from recording to recording: of sensors, or of what is known of the forces.

Each recording of one rig has its own, as it has a state of its own in which it begins: what differs from day
to day is no physics.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.search import NEAR_NOISE_CHI2
from rthm_analysis.diagnosis.criteria.zeros import (
    ZERO_ROUNDS,
    ZERO_SEEN_SHARE,
    ZERO_STDS,
    ZERO_TRIAL_SHARE,
    ZERO_WORTH_SHARE,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitting
from rthm_analysis.diagnosis.physical.beginning import noise_left
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
        What each reads at a true value of zero; 0 and infinity where states in which runs begin stand for it.
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
    def gone(self) -> float:
        """What a zero for each recording removes beyond one for all of them."""
        return self.shared - self.left

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


class Compared(NamedTuple):
    """Recordings beside what a model of their rig predicts, in runs that begin in states which fit each.

    Attributes
    ----------
    evidence : Evidence
    spec : Spec
    first : (m,) array
        Command in steady state before the tests, m.
    fitting : Fitting
        Over all of them, the last included.
    residual : (s k,) array
        Errors over the noise.
    """

    evidence: Evidence
    spec: Spec
    first: Floats
    fitting: Fitting
    residual: Floats

    def again(self, zeros: Zeros) -> Compared:
        """The same with zeros taken from the recordings, and the same noise."""
        seen = replace(zeros.taken_from(self.evidence, self.spec.plant.dofs), own_zero=())
        return compared(seen, self.spec, self.first, self.fitting.sigma)


def compared(evidence: Evidence, spec: Spec, first: Floats, sigma: Floats | None = None) -> Compared:
    """Compare recordings with a model; their noise (k,) is what it leaves of them, if none is given."""
    runs = windows(evidence, spec, evidence.driven_by == "command")
    experiment = Experiment(evidence, first, evidence.stamps_ns[runs.start])
    noise = noise_left(experiment, spec, runs).sigma if sigma is None else sigma
    fitting = Fitting(experiment, runs, noise, Model(spec))
    return Compared(evidence, spec, first, fitting, fitting.residual(fitting.base))


def zeros_of(beside: Compared, targets: tuple[Channel, ...]) -> Zeros | None:
    """Zeros of some signals in each recording that fit best; None where the model diverges."""
    found = _step(beside, targets)
    for _ in range(ZERO_ROUNDS - 1):
        if found is None or found.gone < ZERO_WORTH_SHARE * (found.shared - found.expected):
            return found
        more = _step(beside.again(found), targets)
        found = more and more._replace(values=found.values + more.values, shared=found.shared)
    return found


def _step(beside: Compared, targets: tuple[Channel, ...]) -> Zeros | None:
    """One step towards the zeros, and what is left behind it."""
    fitting, residual = beside.fitting, beside.residual
    whole = np.stack([_response(beside, one) for one in targets])
    if not (np.isfinite(residual).all() and np.isfinite(whole).all()):
        return None
    left, columns = fitting.projected(residual), fitting.projected(whole)
    width, each = fitting.channels, []
    for one in beside.evidence.recordings:
        rows = slice(one.start * width, one.stop * width)
        each.append(_solved(left[rows], columns[:, rows], whole[:, rows]))
    shared = _solved(left, columns, whole)[2]
    values, stds, squares = (np.array(some) for some in zip(*each, strict=True))
    return Zeros(targets, values, stds, float(squares.sum()), shared, fitting.expected)


def _response(beside: Compared, target: Channel) -> Floats:
    """Change of all that is measured (s k,), over the noise, with a zero that is one unit higher in all
    recordings.
    """
    evidence, fitting, spec = beside.evidence, beside.fitting, beside.spec
    if target.family != LOAD:
        column = np.zeros_like(evidence.measured)
        column[:, evidence.channels.index(target)] = 1.0
        return (column * fitting.weight).ravel()
    size = _trial(evidence, spec, target.place)
    load = evidence.load.copy()
    load[:, spec.plant.dofs.index(target.place)] -= size
    pushed = Experiment(replace(evidence, load=load), beside.first, fitting.experiment.starts_ns)
    predicted = pushed.predicted(spec, fitting.windows)
    return np.asarray((beside.residual - fitting.errors(predicted)) / size)


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
