"""How noisy a channel is, from what no motion of the test can explain: its fastest part."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rthm_analysis.diagnosis.fitting.colour import Colour, white
from rthm_analysis.diagnosis.replay.readings import noise_level
from rthm_core.compiled import Flags, Floats


@dataclass(frozen=True)
class Noise:
    """Noise of all channels.

    Attributes
    ----------
    colours : tuple of k Colour
    """

    colours: tuple[Colour, ...]

    @property
    def sigma(self) -> Floats:
        """Standard deviations (k,) of the innovations: what cannot be foretold from the samples before."""
        return np.array([colour.innovation for colour in self.colours])

    @property
    def level(self) -> Floats:
        """Standard deviations (k,) of the noise as a whole."""
        return np.array([colour.level for colour in self.colours])

    @property
    def is_white(self) -> bool:
        """Whether no channel's noise has a colour."""
        return all(colour.is_white for colour in self.colours)

    def smaller(self, other: Noise) -> Noise:
        """Of each channel the smaller noise."""
        pairs = zip(self.colours, other.colours, strict=True)
        return Noise(tuple(a if a.level <= b.level else b for a, b in pairs))

    def kept(self, where: Flags, other: Noise) -> Noise:
        """The same where (k,) it has a colour and says so; else the other noise."""
        triples = zip(where, self.colours, other.colours, strict=True)
        return Noise(tuple(a if here and not a.is_white else b for here, a, b in triples))

    def not_shared(self, other: Noise) -> Noise:
        """The same; the other noise of channels whose colour another channel shows, too."""
        pairs = zip(self.colours, other.colours, strict=True)
        return Noise(tuple(b if a.shared else a for a, b in pairs))


def white_noise(levels: Floats) -> Noise:
    """White noise of some standard deviations (k,)."""
    return Noise(tuple(white(float(level)) for level in levels))


def noise_levels(residual: Floats, measured: Floats) -> Floats:
    """Noise (k,) of all channels from their residuals and measurements (s, k), see `noise_level`."""
    return np.array([noise_level(r, y) for r, y in zip(residual.T, measured.T, strict=True)])
