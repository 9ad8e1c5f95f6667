"""What an error of one position would be in other signals, if a force had made it."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from rthm_analysis.diagnosis.criteria.noise import (
    DENIED_SHARE,
    DENIED_STDS,
    DENYING_POWER_RATIO,
    INDEPENDENT_SHARE,
    SLOW_SAMPLES,
)
from rthm_analysis.diagnosis.criteria.readings import WANDER_LEAST_RESPONSE
from rthm_analysis.diagnosis.physical.remainder import averages
from rthm_core.compiled import Floats
from rthm_core.substructure import Substructure


def forces_on(dofs: int) -> tuple[Floats, Floats]:
    """Unit forces (p, n) on each dof, and (q, n) between each two dofs, in the order of `combinations`."""
    alone = np.eye(dofs)
    pairs = [alone[one] - alone[other] for one, other in combinations(range(dofs), 2)]
    return alone, np.reshape(pairs, (-1, dofs))


def moved_elsewhere(
    plant: Substructure, force: Floats, error: Floats, step: float, dofs: tuple[int, int], rates: int
) -> Floats:
    """Motion (s,) of the second dof under that force which moves the first by an error (s,).

    Parameters
    ----------
    plant : Substructure
    force : (n,) array
        Its share on each dof.
    error : (s,) array
        Equally spaced.
    step : float
        Time between two values, s.
    dofs : (int, int)
    rates : int
        0: position of the second dof; 1: its velocity; 2: its acceleration.
    """
    mirrored = np.concatenate([error, error[::-1]])  # so that its end meets its beginning
    omega = 2.0 * np.pi * np.fft.rfftfreq(mirrored.size, step)
    at = omega[:, None, None]
    dynamic = plant.stiffness - at**2 * plant.mass + 1j * at * plant.damping
    own, other = np.linalg.solve(dynamic, force.astype(complex)[:, None])[:, list(dofs), 0].T
    power = np.square(np.abs(own))
    ratio = other * own.conj() / (power + WANDER_LEAST_RESPONSE * power.max())
    spectrum = np.fft.rfft(mirrored) * ratio * (1j * omega) ** rates
    return np.asarray(np.fft.irfft(spectrum, mirrored.size)[: error.size], dtype=float)


def is_denied(shown: Floats, left: Floats, sigma: float) -> bool:
    """Whether a signal would show more than its noise of something, and does not.

    Parameters
    ----------
    shown : (s,) array
        What it would show.
    left : (s,) array
        What is left of it; 0 where nothing was measured.
    sigma : float
        Its noise.
    """
    shown, left = averages(shown), averages(left)
    if float(shown @ shown) < DENYING_POWER_RATIO * shown.size * sigma**2 / SLOW_SAMPLES:
        return False
    return lacks(left, shown)


def lacks(left: Floats, shown: Floats) -> bool:
    """Whether what is left (a,) of a signal lacks what it would show (a,), both in averages."""
    power = float(shown @ shown)
    part = float(left @ shown) / power
    spread = float(np.sqrt(np.mean(np.square(left - part * shown)) / (INDEPENDENT_SHARE * power)))
    return abs(part) + DENIED_STDS * spread < DENIED_SHARE
