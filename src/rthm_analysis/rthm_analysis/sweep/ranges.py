"""What is varied: ``key=a:b:n`` on the command line."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rthm_core.compiled import Floats
from rthm_core.errors import InputError

WORDS = "key=a:b:n, key=a:b:n:log or key=value,value,..."


class Range(NamedTuple):
    """Values (n,) of one entry of a spec, ascending or as they were given; `log`: evenly spaced in the
    logarithm.
    """

    key: str
    values: Floats
    log: bool = False

    @property
    def begin(self) -> float:
        """First value."""
        return float(self.values[0])

    @property
    def end(self) -> float:
        """Last value."""
        return float(self.values[-1])


def numbers(text: str) -> tuple[Floats, bool]:
    """Values of ``a:b:n`` (evenly spaced, both ends), ``a:b:n:log``, or ``value,value,...``.

    Raises
    ------
    InputError
        When the text is none of these.
    """
    parts = text.split(":")
    log = len(parts) == 4 and parts[3] == "log"
    try:
        if len(parts) == 1:
            return _finite(np.array([float(one) for one in text.split(",")]), text), False
        if len(parts) != 3 and not log:
            raise ValueError
        begin, end, count = float(parts[0]), float(parts[1]), int(parts[2])
        if count < 1 or (log and min(begin, end) <= 0.0):
            raise ValueError
        spaced = np.geomspace(begin, end, count) if log else np.linspace(begin, end, count)
        return _finite(spaced, text), log
    except (ValueError, OverflowError):
        raise InputError(
            f"the values {text!r} are not understood, allowed is a:b:n (n values from a to b), a:b:n:log "
            f"(a and b above zero) or value,value,...; correct them."
        ) from None


def _finite(values: Floats, text: str) -> Floats:
    if not np.isfinite(values).all():
        raise ValueError(text)
    return values


def given_range(text: str) -> Range:
    """Range of ``key=a:b:n``.

    Raises
    ------
    InputError
        When there is no key or its values are not understood.
    """
    key, equals, values = text.partition("=")
    if not equals or not key.strip():
        raise InputError(f"{text!r} is not understood, allowed is {WORDS}; correct it.")
    return Range(key.strip(), *numbers(values))
