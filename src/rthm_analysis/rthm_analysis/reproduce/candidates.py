"""The paper's loop, and the sets of M2, k1 and k3 that all fit what the paper says.

M2 and k3 cannot be recovered from the paper's text; one resonance near 2.4 rad/s is the only constraint.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

from rthm_core.compiled import Floats
from rthm_core.spec import Spec, apply, shipped_spec
from rthm_core.substructure import natural_frequencies


class Candidate(NamedTuple):
    """A set of unrecoverable parameters: kg, N/m, N/m."""

    M2: float
    k1: float
    k3: float

    @property
    def label(self) -> str:
        """Name in tables."""
        return f"M2 {self.M2:g} kg, k1 {self.k1:g} N/m, k3 {self.k3:g} N/m"


CHOSEN = Candidate(1.5, 12.0, 6.0)
"""What every figure is drawn with."""

OTHERS = (
    Candidate(1.0, 12.0, 3.0),
    Candidate(1.2, 12.0, 4.0),
    Candidate(2.5, 12.0, 12.0),
    Candidate(1.8, 6.0, 12.0),
)
ALL = (CHOSEN, *OTHERS)


@cache
def paper() -> Spec:
    """The paper's loop with the chosen set."""
    return shipped_spec("paper")


def loop(one: Candidate = CHOSEN, **changes: object) -> Spec:
    """The paper's loop with a set, and with other values by dotted name."""
    sets = {"numerical.mass": one.M2, "plant.stiffness": one.k1, "numerical.stiffness": one.k3}
    return apply(paper(), sets | changes)


def spread(measure: Callable[[Candidate], float]) -> tuple[float, float]:
    """Smallest and largest of a number over all sets."""
    values = [measure(one) for one in ALL]
    return min(values), max(values)


def modes(one: Candidate) -> Floats:
    """Undamped natural frequencies of the ideal system, rad/s, ascending."""
    from rthm_core.engine.coupled.body import coupled_body

    body = coupled_body(loop(one), "ideal")
    return natural_frequencies(body.mass, body.stiffness)
