"""Bad input, said in one sentence: what, its value, what is allowed, the way out."""

from __future__ import annotations

import reprlib
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any

LEAST_BEGUN = 3
"""Letters from which the beginning of a name stands for it."""

_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = _SHORT.maxlong = 60
_SHORT.maxlevel = 2


class _Missing:
    """What is shown for a value that was not given at all."""

    def __repr__(self) -> str:
        return "missing"


MISSING = _Missing()


class InputError(ValueError):
    """Something that a user gave cannot be used; the message is one sentence with the way out."""


class RefusedError(ValueError):
    """A value that is not allowed, told by a part that does not know the value's full name.

    Parameters
    ----------
    value
        What was given.
    allowed
        What may be given, as the end of "must be ...".
    way_out
        What to do; by default "correct it".
    within
        Name below the part's own name: ``mass``, ``[2]``; empty for the part itself.
    """

    def __init__(self, value: object, allowed: str, way_out: str = "", within: str = "") -> None:
        super().__init__(f"is {shown(value)}, but must be {allowed}")
        self.value = value
        self.allowed = allowed
        self.way_out = way_out
        self.within = within

    def at(self, key: str) -> InputError:
        """Return the error with the full, dotted `key` of the part."""
        return refusal(joined(key, self.within), self.value, self.allowed, self.way_out)


def refusal(key: str, value: object, allowed: str, way_out: str = "") -> InputError:
    """One sentence about a value that is not allowed."""
    way_out = way_out or ("add it" if value is MISSING else "correct it")
    return InputError(f"{printable(key)} is {shown(value)}, but must be {allowed}; {way_out}.")


def nearest(given: str, known: Iterable[str]) -> str | None:
    """Return the known name that was meant: the one that begins so, or the most alike; None: none is near.

    Examples
    --------
    >>> nearest("coulom", ["coulomb_friction", "cubic_stiffness"])
    'coulomb_friction'
    >>> nearest("papr", ["paper", "step"])
    'paper'
    """
    given, names = given[:100], list(known)
    begun = [name for name in names if len(given) >= LEAST_BEGUN and name.startswith(given)]
    return begun[0] if len(begun) == 1 else next(iter(get_close_matches(given, names, n=1)), None)


def suggestion(given: str, known: Iterable[str]) -> str:
    """Return "write ..." with the known name that was meant; empty when none is near."""
    meant = nearest(given, known)
    return f"write {meant}" if meant else ""


def unknown(key: str, value: object, known: Iterable[str]) -> InputError:
    """One sentence about a key that nothing knows; `known` are the keys that could stand there."""
    names = list(known)
    way_out = suggestion(key.rpartition(".")[2], names) or "remove it"
    return InputError(
        f"{printable(key)} (given as {shown(value)}) is not a key of the spec, "
        f"which knows {', '.join(names)} there; {way_out}."
    )


def joined(key: str, within: str) -> str:
    """Dotted name of a part: ``joined("plant", "mass")``, ``joined("plant.mass", "[0]")``."""
    if not key or not within or within.startswith("["):
        return key + within
    return f"{key}.{within}"


def shown(value: Any) -> str:
    """Value as a short piece of one line."""
    if value is None:
        return "empty"
    return _SHORT.repr(list(value) if isinstance(value, tuple) else value)


def printable(name: str) -> str:
    """Return a name as it stands, or quoted when it is empty, long or would break the line."""
    return name if name and name.isprintable() and len(name) <= 120 else shown(name)
