"""What was found of a component."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

from rthm_analysis.diagnosis.result import Value


@dataclass(frozen=True)
class Term:
    """One part of the force.

    Attributes
    ----------
    kind : str
        Of the library; or ``offset``, ``stiffness`` or ``damping``.
    called : str
        What it is called within a sentence.
    parameters : dict of Value
        Where all inputs are zero.
    by_input : dict of dict of Value
        By input, or ``name^2``: what is added to a parameter for each unit of it.
    memory : bool
        Whether it depends on what was before.
    """

    kind: str
    called: str
    parameters: dict[str, Value]
    by_input: dict[str, dict[str, Value]] = field(default_factory=dict)
    memory: bool = False


@dataclass(frozen=True)
class Errors:
    """Root mean square of the force's error on unseen data, N, and the noise of its sensor."""

    plain: float
    found: float
    noise: float


@dataclass(frozen=True)
class ComponentFinding:
    """What the force of a component follows from.

    Attributes
    ----------
    verdict : str
        ``explained``: nothing but noise is left of unseen data; ``improved``: less than spring and damper
        leave; ``unexplained``.
    words : str
        What the force follows from, for a test engineer.
    motion, force : str
        Names of the signals.
    terms : tuple of Term
        None where the verdict is ``unexplained``.
    lags : dict of Value
        By input that the force depends on, s.
    depends_on : tuple of str
        ``x``, ``v`` and inputs.
    errors : Errors
    force_std : float
        Of the measured force on unseen data, N.
    held_out : str
        Which data were not seen, in words.
    notes : tuple of str
    """

    verdict: str
    words: str
    motion: str
    force: str
    terms: tuple[Term, ...]
    lags: dict[str, Value]
    depends_on: tuple[str, ...]
    errors: Errors
    force_std: float
    held_out: str
    notes: tuple[str, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """What is told as JSON."""
        return asdict(self)
