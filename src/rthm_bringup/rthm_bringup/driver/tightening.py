"""Wires brought to their pretension by hand, step by step, by what the load cells read."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

from rthm_actuator.sensors import FORCE
from rthm_bringup.driver.rest import Reading, unrest
from rthm_core.limits import kept_limits

if TYPE_CHECKING:
    from rthm_core.spec import Spec

WITHIN = 0.5
"""How near the tension has to come, over `limits.start`: a run looks again, and allows more."""
STEADY = 4
"""Looks in a row at which all wires have to be right."""


class Wire(NamedTuple):
    """Tension of one wire.

    Attributes
    ----------
    name
        Of the actuator.
    tension, wanted, tolerance, limit
        Measured, by the spec, allowed difference, and what it must never pass, N.
    """

    name: str
    tension: float
    wanted: float
    tolerance: float
    limit: float

    @property
    def is_right(self) -> bool:
        """Whether the tension is what is wanted."""
        return abs(self.tension - self.wanted) <= self.tolerance

    @property
    def line(self) -> str:
        """What is to be done, with the figures."""
        what = "right" if self.is_right else "tighten" if self.tension < self.wanted else "loosen"
        return f"{self.name}: {self.tension:.4g} N of {self.wanted:.4g} +- {self.tolerance:.2g} N, {what}"


def wires(spec: Spec, found: Sequence[Reading]) -> list[Wire]:
    """Wires of a rig, by what its load cells read above their zero with slack wires."""
    actuator, limits = spec.loop().actuator, kept_limits(spec, hardware=True)
    assert limits.start is not None
    most = min(one for one in (limits.force, limits.measured_force) if one is not None)
    tension = [one.mean for one in found if one.channel.kind == FORCE]
    return [
        Wire(name, pull, wanted, WITHIN * limits.start[1], most)
        for name, pull, wanted in zip(actuator.names, tension, actuator.pretension, strict=True)
    ]


def approach(
    spec: Spec,
    look: Callable[[], list[Reading]],
    tell: Callable[[str], None],
    late: Callable[[], bool],
) -> str:
    """Lead a hand to the pretension of a spec; why it is not there, empty when it is.

    Parameters
    ----------
    look
        Reads the sensors for a moment.
    tell
        Told what is to be done, whenever that changes.
    late
        Whether the time is over.
    """
    said, steady = "", 0
    while steady < STEADY:
        found = look()
        now = wires(spec, found)
        beyond = [one for one in now if not one.tension <= one.limit]
        if beyond:
            one = beyond[0]
            return (
                f"The wire of {one.name} pulls {one.tension:.4g} N, but may pull {one.limit:.4g} N; let go."
            )
        words = "; ".join(one.line for one in now)
        if words != said:
            tell(words)
            said = words
        steady = steady + 1 if all(one.is_right for one in now) and not unrest(found) else 0
        if late() and steady < STEADY:
            return (
                f"The pretension was not reached in time ({words}); run rthm pretension again to "
                "continue from there."
            )
    return ""
