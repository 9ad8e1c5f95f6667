"""The wires on their own: the force that they carry along the recorded motion of motor and plant.

A hysteretic or rubbing wire can bend the motion of the plant as a missing force on the plant does. But what
a wire does also shows in its own force, and there nothing else does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import (
    WIRE_BLOCK_LENGTHS,
    WIRE_CLAIM_STDS,
    WIRE_EFFECT_SHARE,
    WIRE_EFFECT_STDS,
    WIRE_FEWEST_BLOCKS,
    WIRE_SMOOTHED_SAMPLES,
)
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_analysis.diagnosis.signals import filled, smoothed

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.evidence import Evidence
    from rthm_analysis.diagnosis.replay.model import Model
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


class WiresAlone:
    """One-block check of the wires of a recorded test; lets everything pass where forces were not measured.

    Parameters
    ----------
    experiment : Experiment
    spec : Spec
    sigma : (k,) array
        Noise of the channels.
    """

    def __init__(self, experiment: Experiment, spec: Spec, sigma: Floats) -> None:
        evidence = experiment.evidence
        self.forces = [i for i, one in enumerate(evidence.channels) if one.family == "force"]
        motion = _recorded_motion(evidence, spec) if self.forces else None
        if motion is None:
            self.forces = []
            return
        self.weight = 1.0 / sigma[self.forces]
        self.windows = Windows(np.arange(evidence.stamps_ns.size), motion, None)
        self.experiment = Experiment(
            evidence, experiment.first, between=experiment.between, budget=experiment.budget
        )
        self.experiment.begin_at(evidence.stamps_ns)

    def contradict(self, model: Model, added: Model) -> bool:
        """Whether the forces deny the last effect of `added`, a wire's, that `model` does not have.

        They do when they show nothing of its shape, and when what is left of them has not even room for it:
        the shape alone may be wrong before a fit.
        """
        if not self.forces:
            return False
        here = self._predicted(model)
        claimed = (self._predicted(added) - here) * self.weight
        measured = self.experiment.evidence.measured[:, self.forces]
        known = np.isfinite(measured).all(axis=1)
        claimed, left = averaged(claimed[known], ((measured - here) * self.weight)[known])
        size, count = float(np.linalg.norm(claimed)), claimed.size
        seen = float(np.sum(left * claimed)) / max(size, 1e-300)
        room = max(float(np.sum(np.square(left))) - count, 0.0) + WIRE_CLAIM_STDS * np.sqrt(2.0 * count)
        return bool(size**2 > room and seen < min(WIRE_EFFECT_STDS, WIRE_EFFECT_SHARE * size))

    @property
    def size(self) -> int:
        """Number of residuals."""
        return self.windows.start.size * len(self.forces)

    def residual(self, model: Model) -> Floats:
        """Measured minus predicted forces over their noise, in one row; 0 where nothing was measured."""
        measured = self.experiment.evidence.measured[:, self.forces]
        left = (measured - self._predicted(model)) * self.weight
        return np.where(np.isfinite(measured), left, 0.0).ravel()

    def _predicted(self, model: Model) -> Floats:
        return self.experiment.predicted(model.spec, self.windows)[:, self.forces]


def averaged(claimed: Floats, left: Floats) -> tuple[Floats, Floats]:
    """Both signals (s, m) as averages, of the same noise, over the blocks in which what is claimed stands out
    most: what a wire does is slow against its samples, and in long averages little noise stands beside it.
    """
    best, clearest = (claimed, left), 0.0
    for length in WIRE_BLOCK_LENGTHS:
        count = claimed.shape[0] // length
        if count < WIRE_FEWEST_BLOCKS:
            break
        blocks = (values[: count * length].reshape(count, length, -1) for values in (claimed, left))
        averages = [values.sum(axis=1) / np.sqrt(length) for values in blocks]
        clear = float(np.sum(np.square(averages[0]))) / np.sqrt(averages[0].size)
        if clear > clearest:
            best, clearest = (averages[0], averages[1]), clear
    return best


def _recorded_motion(evidence: Evidence, spec: Spec) -> Floats | None:
    """Smoothed positions and velocities at the samples (s, 2 n); None where a position was not measured."""
    assert spec.plant is not None
    n = len(spec.plant.dofs)
    motion = np.full((evidence.stamps_ns.size, 2 * n), np.nan)
    for i, channel in enumerate(evidence.channels):
        if channel.family in ("position", "velocity"):
            values = evidence.measured[:, i]
            if np.isfinite(values).sum() < WIRE_SMOOTHED_SAMPLES:
                return None
            column = spec.plant.dofs.index(channel.place) + (n if channel.family == "velocity" else 0)
            motion[:, column] = smoothed(filled(values), WIRE_SMOOTHED_SAMPLES)
    for dof in range(n):
        if np.isnan(motion[0, n + dof]):
            motion[:, n + dof] = evidence.rates(motion[:, dof])
    return None if np.isnan(motion).any() else motion
