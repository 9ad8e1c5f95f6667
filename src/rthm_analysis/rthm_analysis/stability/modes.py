"""Modes of a sampled loop: the continuous equivalents of the eigenvalues over one hyperperiod."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rthm_analysis.lifted.harmonics import Complex, components
from rthm_analysis.lifted.lifted import Lifted

FORGOTTEN = 1e-9
"""Eigenvalues smaller than this, relative to the largest, are what rounding leaves of the memory."""


@dataclass(frozen=True)
class Mode:
    """One mode, or a pair of conjugate ones.

    Attributes
    ----------
    exponent : complex
        s of the motion ``e^{st}`` times something that repeats itself every hyperperiod, 1/s; Im s >= 0.
    """

    exponent: complex

    @property
    def frequency(self) -> float:
        """Natural frequency |s|, rad/s."""
        return abs(self.exponent)

    @property
    def damping_ratio(self) -> float:
        """-Re s / |s|; negative: the mode grows."""
        return -self.exponent.real / abs(self.exponent) if self.exponent else 0.0

    def as_dict(self) -> dict[str, float]:
        """Entry of ``modes`` in the JSON of ``rthm stability``."""
        return {
            "frequency": self.frequency,
            "damping_ratio": self.damping_ratio,
            "damped_frequency": self.exponent.imag,
            "growth_rate": self.exponent.real,
        }


def modes(lifted: Lifted, monodromy: np.ndarray, most: int | None = None) -> tuple[Mode, ...]:
    """Modes, the one that fades most slowly (or grows fastest) first; `most` of them, if given."""
    reach = _aliases(lifted)
    values, vectors = np.linalg.eig(monodromy)
    size = np.abs(values)
    kept = (size > FORGOTTEN * size.max(initial=0.0)) & (values.imag >= 0.0)
    order = np.flatnonzero(kept)[np.argsort(-size[kept], kind="stable")][:most]
    return tuple(Mode(_exponent(lifted, complex(values[i]), vectors[:, i], reach)) for i in order)


def _aliases(lifted: Lifted) -> int:
    """How many aliases on either side of an eigenvalue are no faster than the loop itself."""
    spacing = 2.0 * np.pi / lifted.cycle.hyperperiod
    return int((1.5 * lifted.loop.fastest_oscillation + spacing / 2.0) // spacing)


def _exponent(lifted: Lifted, value: complex, vector: Complex, reach: int) -> complex:
    """The one of the logarithms of an eigenvalue at which the positions move most.

    An eigenvalue leaves the frequency open up to multiples of 2 pi / T (aliases, of which `reach` on either
    side are possible). The motion does not: it is largest in the component of the true one.
    """
    period = lifted.cycle.hyperperiod
    principal = np.log(complex(value)) / period
    spacing = 2.0 * np.pi / period
    if reach == 0:
        return _upper(principal)
    candidates = principal + 1j * spacing * np.arange(-reach, reach + 1)
    found = components(lifted, vector[:, None].astype(complex), candidates)
    return _upper(complex(candidates[np.argmax(np.linalg.norm(found[:, 0], axis=0))]))


def _upper(s: complex) -> complex:
    return complex(s.real, abs(s.imag))
