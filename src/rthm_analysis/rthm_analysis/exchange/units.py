"""Units that files come in, as factors to SI."""

from __future__ import annotations

import math
import re

from rthm_core.errors import InputError, shown

_LENGTHS = {
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "nm": 1e-9,
    "in": 0.0254,
    "inch": 0.0254,
    "ft": 0.3048,
}

_ANGLES = {
    "rad": 1.0,
    "mrad": 1e-3,
    "deg": math.pi / 180.0,
    "\N{DEGREE SIGN}": math.pi / 180.0,
    "rev": 2.0 * math.pi,
}
"""Angles stand for positions, and moments for forces."""

_FORCES = {"N": 1.0, "mN": 1e-3, "kN": 1e3, "MN": 1e6, "lbf": 4.4482216152605, "kgf": 9.80665}

_MOMENTS = {f"{unit}{gap}m": _FORCES[unit] for unit in ("N", "mN", "kN", "MN") for gap in (" ", "")}

_RATES = {f"{unit}/s": factor for unit, factor in (_LENGTHS | _ANGLES).items()}

_ACCELERATIONS = {f"{unit}^2": factor for unit, factor in _RATES.items()} | {
    "g": 9.80665,
    "mg": 9.80665e-3,
    "gal": 1e-2,
    "mgal": 1e-5,
}

FACTORS: dict[str, dict[str, float]] = {
    "s": {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0},
    "m": _LENGTHS | _ANGLES,
    "m/s": _RATES | {"km/h": 1.0 / 3.6, "rpm": math.pi / 30.0},
    "m/s^2": _ACCELERATIONS,
    "N": _FORCES | _MOMENTS,
    "1": {
        "1": 1.0, "V": 1.0, "mV": 1e-3, "A": 1.0, "mA": 1e-3, "%": 1.0, "K": 1.0, "degC": 1.0, "Pa": 1.0,
        "kPa": 1e3, "bar": 1e5, "Hz": 1.0,
    },
}  # fmt: skip
"""By SI unit; an input may have any of the last."""

INPUT_UNITS = {"mV": "V", "mA": "A", "kPa": "Pa", "bar": "Pa"}
"""SI unit of an input, where it is another than that of the file."""

TURNING = {"m": "rad", "m/s": "rad/s", "m/s^2": "rad/s^2", "N": "N m"}
"""SI unit of an angle, its rates or a moment, by that of what it stands for."""

_TURNING_UNITS = {*(f"{unit}{over}" for unit in _ANGLES for over in ("", "/s", "/s^2")), "rpm", *_MOMENTS}

_PER_SECOND_SQUARED = re.compile(r"(/s/s|/s\*{0,2}2|/s\N{SUPERSCRIPT TWO}|[ .*]s\^?-2)$")
"""Other ways to write /s^2."""

_OTHER_SPELLINGS = {"G": "g", "g_n": "g", "gn": "g", "g0": "g", "mG": "mg", "Gal": "gal", "mGal": "mgal"}

_FACTOR = re.compile(r"^(?P<number>[-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*\*?\s*(?P<unit>.*)$")


def factor(text: str, si: str, what: str) -> float:
    """Factor from a unit to SI.

    Parameters
    ----------
    text : str
        A unit (``mm``), a number of SI units (``35.15``) or of other units (``0.5 kN``).
    si : str
        ``s``, ``m``, ``m/s``, ``m/s^2``, ``N``, or ``1`` for an input.
    what : str
        What has the unit, for the sentence.

    Raises
    ------
    InputError
        The unit is not known, or the factor is zero or not finite.
    """
    number, unit = _split(text, si)
    known = FACTORS[si]
    if unit not in known or not 0.0 < abs(number * known[unit]) < float("inf"):
        raise InputError(
            f"The unit of {what} is {shown(text)}, but must be one of {', '.join(known)} or the number of "
            f"{si} that one of it is; give that number with --unit."
        )
    return number * known[unit]


def si_unit(text: str, si: str) -> str:
    """SI unit of values in some unit: that of an angle or a moment where the unit is one of these."""
    unit = _split(text, si)[1]
    if si == "1":
        return INPUT_UNITS.get(unit, unit)
    return TURNING.get(si, si) if unit in _TURNING_UNITS else si


def _split(text: str, si: str) -> tuple[float, str]:
    """Number and unit of a factor."""
    found = _FACTOR.match(text.strip())
    number, unit = (float(found["number"]), found["unit"] or si) if found else (1.0, text.strip())
    unit = unit.replace("\N{MICRO SIGN}", "u").replace("\N{GREEK SMALL LETTER MU}", "u")
    if si == "m/s^2":
        unit = _PER_SECOND_SQUARED.sub("/s^2", _OTHER_SPELLINGS.get(unit, unit))
    return number, unit
