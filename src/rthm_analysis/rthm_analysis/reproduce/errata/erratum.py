"""What a check of an equation says."""

from __future__ import annotations

from dataclasses import asdict, dataclass


@dataclass(frozen=True)
class Erratum:
    """An equation, and how far it is off as printed and as corrected.

    Attributes
    ----------
    equation, printed, corrected : str
        Number, and the place in words.
    check : str
        What is compared with what, and in which unit.
    error_printed : float or None
        Deviation of the printed form; None where it cannot be evaluated at all.
    error_corrected : float
        Deviation of the corrected form.
    """

    equation: str
    printed: str
    corrected: str
    check: str
    error_printed: float | None
    error_corrected: float

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return asdict(self)
