"""Factors that a wrong unit makes, and which of them a gain is."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import EXACT_UNIT_LOG, LARGE_UNIT_LOG, UNITLESS_GAIN

_LENGTHS = {
    "mm": 1e3,
    "cm": 1e2,
    "um": 1e6,
    "inch": 1.0 / 0.0254,
    "ft": 1.0 / 0.3048,
    "degrees": 180.0 / np.pi,
}

RATIOS: dict[str, dict[str, float]] = {
    "position": _LENGTHS,
    "motor": _LENGTHS,
    "velocity": {f"{unit}/s": ratio for unit, ratio in _LENGTHS.items()} | {"km/h": 3.6, "rpm": 30.0 / np.pi},
    "acceleration": {f"{unit}/s^2": ratio for unit, ratio in _LENGTHS.items()} | {"g": 1.0 / 9.80665},
    "force": {
        "mN": 1e3,
        "kN": 1e-3,
        "gf": 1e3 / 9.80665,
        "kgf": 1.0 / 9.80665,
        "lbf": 1.0 / 4.4482216152605,
    },
}
"""By family: numbers of a unit that make one SI unit."""


def known_factor(gain: float, family: str, more: float = 0.0) -> float | None:
    """Recorded over true value: +-1, or the ratio of a unit either way, + or -; None where it is none.

    Parameters
    ----------
    gain : float
        As it was measured.
    family : str
        ``position``, ``velocity``, ``acceleration``, ``force``, ``motor`` or ``load``.
    more : float
        Relative uncertainty of the gain itself; where it is large, ratios below a hundred are no evidence.

    Examples
    --------
    >>> known_factor(-0.98, "velocity"), known_factor(1003.0, "position"), known_factor(7.0, "force")
    (-1.0, 1000.0, None)
    """
    size, sign = abs(gain), float(np.sign(gain))
    if not np.isfinite(gain) or size == 0.0:
        return None
    if UNITLESS_GAIN[0] <= size <= UNITLESS_GAIN[1]:
        return sign
    ratios = RATIOS["force" if family == "load" else family].values()
    for ratio in (*ratios, *(1.0 / one for one in ratios)):
        large = ratio >= 99.0 or ratio <= 0.0101
        if not large and more > EXACT_UNIT_LOG:
            continue
        if abs(np.log(size / ratio)) < (LARGE_UNIT_LOG + more if large else EXACT_UNIT_LOG):
            return sign * ratio
    return None


def unit_of(factor: float, family: str) -> str:
    """Name of the unit in which values are so many times the SI values; empty where there is none."""
    ratios = RATIOS["force" if family == "load" else family]
    return next((unit for unit, ratio in ratios.items() if abs(abs(factor) / ratio - 1.0) < 1e-6), "")
