"""The wall clock of this host, by which all stamps of a test are made.

For tests of hosts whose clocks differ, ``RTHM_CLOCK`` makes one that is wrong: ``OFFSET [DRIFT REFERENCE]``,
the lead in s at the instant `REFERENCE` (s since 1970) and its growth in s/s. Everything of ours on the host
is to have the same.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable

from rthm_core.clock import NS
from rthm_core.errors import InputError

VARIABLE = "RTHM_CLOCK"


def wall_ns() -> int:
    """Nanoseconds since 1970."""
    return _wrong(time.time_ns())


def emulated(text: str) -> Callable[[int], int]:
    """What a clock shows, by the true time (both ns); `text` as in ``RTHM_CLOCK``, empty: a right clock."""
    if not text:
        return lambda true: true
    try:
        offset, drift, reference = (*map(float, text.split()), 0.0, 0.0)[:3]
        lead, since = round(offset * NS), round(reference * NS)
    except (ValueError, OverflowError) as error:
        raise InputError(
            f"{VARIABLE} is {text!r}, but must be OFFSET or OFFSET DRIFT REFERENCE in numbers; unset it."
        ) from error
    return lambda true: true + lead + round(drift * (true - since))


_wrong = emulated(os.environ.get(VARIABLE, ""))
