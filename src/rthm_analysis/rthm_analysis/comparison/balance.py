"""Energy of one test: what the loop put in, over what was there, and the damper that would have done it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from rthm_analysis.comparison.motion import Motion, Signal

DAMPED = ("E_fx", "E_ff", "E_num", "E_err")
"""Terms that are told as dampers."""


@dataclass(frozen=True)
class Balance:
    """Energies of a test at an instant.

    Attributes
    ----------
    at_end : dict of float
        By term, J, + when introduced.
    error : float
        E_err over the largest E_total; NaN: not known.
    damping : dict of float
        Equivalent damping by term, N s/m, + where it drains.
    """

    at_end: dict[str, float]
    error: float
    damping: dict[str, float]

    def as_dict(self) -> dict[str, object]:
        """Keys of the JSON."""
        return {"at_end": self.at_end, "energy_error": self.error, "equivalent_damping": self.damping}


def balance_of(motion: Motion, until_ns: int) -> Balance:
    """Energies of a test at the instant `until_ns`, ns since its start."""
    known = {name: one for name, one in motion.signals.items() if one.unit == "J"}
    at_end = {name: _newest(one, until_ns) for name, one in known.items()}
    total = known.get("E_total")
    most = float(np.abs(total.values[total.at_ns <= until_ns]).max(initial=0.0)) if total else 0.0
    error = at_end["E_err"] / most if "E_err" in at_end and most else np.nan
    passed = _newest(motion.passed, until_ns) if motion.passed else np.nan
    damping = {term: -at_end[term] / passed for term in DAMPED if term in at_end and passed > 0.0}
    return Balance(at_end, error, damping)


def _newest(signal: Signal, until_ns: int) -> float:
    """Newest value up to an instant; NaN: none."""
    row = int(np.searchsorted(signal.at_ns, until_ns, side="right")) - 1
    return float(signal.values[row]) if row >= 0 else np.nan
