"""Units that files come in, as factors to SI."""

from __future__ import annotations

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

FACTORS: dict[str, dict[str, float]] = {
    "s": {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0},
    "m": _LENGTHS,
    "m/s": {f"{unit}/s": factor for unit, factor in _LENGTHS.items()} | {"km/h": 1.0 / 3.6},
    "N": {"N": 1.0, "mN": 1e-3, "kN": 1e3, "MN": 1e6, "lbf": 4.4482216152605, "kgf": 9.80665},
}
"""By SI unit."""

_FACTOR = re.compile(r"^(?P<number>[-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*\*?\s*(?P<unit>.*)$")


def factor(text: str, si: str, what: str) -> float:
    """Factor from a unit to SI.

    Parameters
    ----------
    text : str
        A unit (``mm``), a number of SI units (``35.15``) or of other units (``0.5 kN``).
    si : str
        ``s``, ``m``, ``m/s`` or ``N``.
    what : str
        What has the unit, for the sentence.

    Raises
    ------
    InputError
        The unit is not known, or the factor is zero or not finite.
    """
    found = _FACTOR.match(text.strip())
    number, unit = (float(found["number"]), found["unit"] or si) if found else (1.0, text.strip())
    unit = unit.replace("\N{MICRO SIGN}", "u").replace("\N{GREEK SMALL LETTER MU}", "u")
    known = FACTORS[si]
    if unit not in known or not 0.0 < abs(number * known[unit]) < float("inf"):
        raise InputError(
            f"The unit of {what} is {shown(text)}, but must be one of {', '.join(known)} or the number of "
            f"{si} that one of it is; give that number with --unit."
        )
    return number * known[unit]
