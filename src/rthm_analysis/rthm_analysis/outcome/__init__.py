"""What a test is worth: whether its loop is stable, by what margin, and how far it is from the ideal system.

`Margin` is known before a test begins, `IdealError` after it; `Outcome` says both in the words of
docs/theory.md.
"""

from typing import TYPE_CHECKING, Any

from rthm_analysis.outcome.ideal import IdealComparison, IdealError
from rthm_analysis.outcome.margin import Margin, margin_of, margin_or_why
from rthm_analysis.outcome.outcome import Lateness, Outcome

if TYPE_CHECKING:
    from rthm_analysis.outcome.recorded import outcome_of

__all__ = [
    "IdealComparison",
    "IdealError",
    "Lateness",
    "Margin",
    "Outcome",
    "margin_of",
    "margin_or_why",
    "outcome_of",
]


def __getattr__(name: str) -> Any:
    """What reads recordings is imported when it is first used: a simulation need not wait for it."""
    if name != "outcome_of":
        raise AttributeError(f"{__name__} has no {name!r}, only {', '.join(__all__)}.")
    from rthm_analysis.outcome.recorded import outcome_of

    return outcome_of
