"""Starting values of a tone: the one in the residual that a force on the dof would make."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.search import TONE_HIGHEST, TONE_HIGHEST_TO_MOTION, TONE_PADDING
from rthm_analysis.diagnosis.replay.evidence import MOTION
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.mechanics import Mechanics, mechanics, state_matrix, wire_forces
from rthm_analysis.diagnosis.replay.model import EffectInstance
from rthm_analysis.diagnosis.search.scene import seen_in
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.effects.registry import ranked

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


def harmonic_starts(
    spec: Spec, experiment: Experiment, residual: Floats, sigma: Floats
) -> Iterator[InitialGuess]:
    """Starts of a tone on each dof.

    Parameters
    ----------
    residual : (s, k) array
        Over the noise.
    sigma : (k,) array
    """
    assert spec.plant is not None
    evidence = experiment.evidence
    time = evidence.time
    step = float(np.median(np.diff(time)))
    even = np.arange(0.0, time[-1], step)
    count = TONE_PADDING * even.size
    omega = 2.0 * np.pi * np.fft.rfftfreq(count, step)
    band = (omega > 2.0 * np.pi / time[-1]) & (
        omega < max(TONE_HIGHEST, TONE_HIGHEST_TO_MOTION * 2.0 * np.pi / evidence.period)
    )
    spectra = []
    for column in residual.T:
        known = np.isfinite(column)
        spectra.append(np.fft.rfft(np.interp(even, time[known], column[known]), count)[band])
    look_elsewhere = 2.0 * np.log(max(np.count_nonzero(band) / TONE_PADDING, 1.0))
    gains = _gains(mechanics(spec, experiment.first), spec, experiment, omega[band], sigma)
    tone = next(law for law in ranked("plant") if law.is_tone)
    for d, dof in enumerate(spec.plant.dofs):
        gain = gains[:, :, d]
        matched = np.sum(np.conj(gain) * np.stack(spectra), axis=0) * 2.0 / even.size
        weight = np.sum(np.abs(gain) ** 2, axis=0)
        score = np.abs(matched) ** 2 / np.maximum(weight, 1e-300)
        for _ in range(2):
            best = int(np.argmax(score))
            force = matched[best] / weight[best]
            w = float(omega[band][best])
            phase = float(np.angle(force) + 0.5 * np.pi - w * float(time[0]))
            values: dict[str, float | str] = {
                "amplitude": float(np.abs(force)),
                "frequency": w,
                "phase": phase,
            }
            scales = {"amplitude": float(np.abs(force)), "frequency": 1.0 / float(time[-1]), "phase": 0.3}
            added = EffectInstance("plant", tone.kind, dof, values, seen_in(time))
            yield InitialGuess(added, tuple(values), ("amplitude",), scales, look_elsewhere=look_elsewhere)
            score[max(best - 3 * TONE_PADDING, 0) : best + 3 * TONE_PADDING] = 0.0


def _gains(arrays: Mechanics, spec: Spec, experiment: Experiment, omega: Floats, sigma: Floats) -> np.ndarray:
    """Response of every channel, over its noise, to a harmonic force on each dof: (k, frequencies, n)."""
    assert spec.plant is not None
    n, ny, force = arrays.n, arrays.initial.size, wire_forces(arrays)
    modes, vectors = np.linalg.eig(state_matrix(arrays).astype(complex))
    entry = np.linalg.lstsq(vectors, arrays.by_loads.astype(complex), rcond=None)[0]
    rows = []
    for channel, noise in zip(experiment.evidence.channels, sigma, strict=True):
        row = np.zeros(ny)
        if channel.family in MOTION:
            i = spec.plant.dofs.index(channel.place)
            row[i if channel.family == "position" else n + i] = 1.0
        elif channel.family == "force" and spec.actuator is not None:
            row = force[spec.actuator.names.index(channel.place)]
        rows.append(row / noise)
    seen = np.stack(rows) @ vectors
    gains = np.einsum("km,fm,mn->kfn", seen, 1.0 / (1j * omega[:, None] - modes), entry)
    accelerations = [c.family == "acceleration" for c in experiment.evidence.channels]
    gains[accelerations] *= 1j * omega[:, None]
    return np.asarray(gains)
