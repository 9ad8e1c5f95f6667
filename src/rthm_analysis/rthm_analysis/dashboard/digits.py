"""Numbers with as many digits as a page can show."""

from __future__ import annotations

import math


def rounded(value: float, digits: int = 7) -> float | None:
    """Return a number with so many digits; None where it is not finite.

    Examples
    --------
    >>> rounded(0.123456789), rounded(math.nan)
    (0.1234568, None)
    """
    return float(f"{value:.{digits}g}") if math.isfinite(value) else None
