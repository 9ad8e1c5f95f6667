"""A small motion that measures a rig: motors stand still for a while, then move about where they stood.

It is the same function of time in the controller that commands it, and in what chooses its size.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_core.errors import refusal

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec

QUIET_START = 1.0
"""Time at the start in which nothing is commanded and the noise of the sensors shows, s."""
SWELL = 0.5
"""Time over which the motion grows, s."""
LINES = 24
"""Sinusoids of each motor."""
LOWEST = np.pi
"""Lowest frequency, rad/s."""
HIGHEST = 0.25
"""Highest frequency, over that which the period of the commands can still show."""
LOOKED_AT = 20.0
"""Time of which the largest value is taken, s; later ones are cut to it."""


class Excitation(NamedTuple):
    """Sinusoids of all motors, of equal speed, with phases of their own.

    Attributes
    ----------
    travel
        Largest distance from where the motors stood, m.
    frequency : (k,) array
        rad/s.
    amplitude, phase : (m, k) arrays
        Over `travel`, and rad.
    """

    travel: float
    frequency: Floats
    amplitude: Floats
    phase: Floats

    def at(self, t: float) -> Floats:
        """Distance of the motors (m,) from where they stood, m, so many seconds after the start."""
        if t <= QUIET_START:
            return np.zeros(self.amplitude.shape[0])
        share = self.travel * 0.5 * (1.0 - np.cos(np.pi * min((t - QUIET_START) / SWELL, 1.0)))
        return np.asarray(share * np.clip(_sum(self, np.array([t]))[0], -1.0, 1.0))


def excitation(spec: Spec, travel: float) -> Excitation:
    """Make the motion of all motors of a spec.

    Parameters
    ----------
    spec
        A complete loop.
    travel
        Largest distance from where the motors stand, m.

    Raises
    ------
    InputError
        If the travel is not above zero, or the spec describes no loop.

    Examples
    --------
    >>> from rthm_core.spec import shipped_spec
    >>> motion = excitation(shipped_spec("paper"), 0.01)
    >>> float(motion.at(0.5)[0]), bool(abs(motion.at(2.0)[0]) <= 0.01)
    (0.0, True)
    """
    if not (np.isfinite(travel) and travel > 0.0):
        raise refusal("--travel", travel, "a distance above 0 m")
    loop = spec.loop()
    m, highest = len(loop.actuator.names), HIGHEST * np.pi / loop.timing.td3
    frequency = np.geomspace(min(LOWEST, 0.1 * highest), highest, LINES)
    phase = np.random.default_rng(0).uniform(0.0, 2.0 * np.pi, (m, LINES))
    made = Excitation(travel, frequency, np.tile(1.0 / frequency, (m, 1)), phase)
    t = np.arange(0.0, LOOKED_AT, min(loop.timing.td3, LOOKED_AT / LINES))
    largest = np.abs(_sum(made, t)).max(axis=0)
    return made._replace(amplitude=made.amplitude / largest[:, None])


def _sum(motion: Excitation, t: Floats) -> Floats:
    """Sum of the sinusoids (t, m)."""
    angle = motion.frequency * t[:, None, None] + motion.phase
    return np.asarray(np.sum(motion.amplitude * np.sin(angle), axis=2))
