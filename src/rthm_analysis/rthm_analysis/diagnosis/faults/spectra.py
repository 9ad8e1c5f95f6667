"""Cross spectra of signals, averaged over overlapping parts of a recording."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import SPECTRA_HIGHEST_RADIANS, SPECTRA_PARTS

if TYPE_CHECKING:
    from rthm_core.compiled import Floats


@dataclass(frozen=True)
class Spectra:
    """Cross spectra of k signals.

    Attributes
    ----------
    omega : (f,) array
        rad/s, without zero.
    cross : (f, k, k) array
        Mean of conj(a) b, in units of the signals.
    parts : int
        How many independent parts were averaged.
    """

    omega: Floats
    cross: np.ndarray
    parts: int

    def coherence(self, one: int, other: int) -> Floats:
        """Squared coherence of two signals."""
        power = self.cross[:, one, one].real * self.cross[:, other, other].real
        return np.asarray(np.abs(self.cross[:, one, other]) ** 2 / np.maximum(power, 1e-300))


def spectra(signals: Floats, step: float) -> Spectra:
    """Cross spectra of signals (s, k) that are sampled every `step` s."""
    length = 2 * signals.shape[0] // (SPECTRA_PARTS + 1)
    starts = np.arange(SPECTRA_PARTS) * (length // 2)
    parts = np.stack([signals[a : a + length] for a in starts])
    parts = (parts - parts.mean(axis=1, keepdims=True)) * np.hanning(length)[:, None]
    values = np.fft.rfft(parts, axis=1)
    omega = 2.0 * np.pi * np.fft.rfftfreq(length, step)
    kept = slice(1, max(int(np.searchsorted(omega, SPECTRA_HIGHEST_RADIANS / step)), 2))
    cross = np.einsum("pfi,pfj->fij", values[:, kept].conj(), values[:, kept]) / SPECTRA_PARTS
    return Spectra(np.asarray(omega[kept], dtype=float), cross, (SPECTRA_PARTS + 1) // 2)
