"""The verdict on a test."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from rthm_analysis.outcome.ideal import IdealError
from rthm_analysis.outcome.margin import Margin

BEYOND = 1e6
"""Error from which a motion has left every rig, m."""

UNSEEN, HARMLESS = 1e-6, 0.01
"""Error by late samples, over the ideal motion, up to which nobody sees it, and timing is called good."""


@dataclass(frozen=True)
class Lateness:
    """What samples that were late, beyond the delays of the spec, changed in a recorded test.

    Attributes
    ----------
    error : float
        Root mean square of the difference between the loop along its recorded delays and along those of the
        spec, both simulated, over that of the ideal motion: of the dof of the plant where it is largest.
    """

    error: float

    @property
    def ok(self) -> bool:
        """Whether timing did not matter."""
        return self.error < HARMLESS

    @property
    def words(self) -> str:
        """One sentence."""
        if self.error < UNSEEN:
            return "Timing did not matter: late samples changed nothing."
        if self.ok:
            return f"Timing did not matter: late samples changed the motion by {_percent(self.error)}."
        return (
            f"Timing mattered: late samples changed the motion by {_percent(self.error)} (of the ideal rms)."
        )

    def as_dict(self) -> dict[str, object]:
        """``timing`` of the verdict (contract, section 5)."""
        return {"ok": self.ok, "error": self.error}


@dataclass(frozen=True)
class Outcome:
    """What a test is worth.

    Attributes
    ----------
    margin : Margin or str
        Or why it is not known.
    error : dict of IdealError
        By dof of the plant; empty where there is no motion to compare.
    lateness : Lateness or None
        None: not known, or nothing can be late.
    limits_touched : tuple of str
        Limits of the spec that the test reached.
    energy_per_cycle : float or None
        Mean work of the errors of the loop in each cycle of the motion, J, + where it is put in; None: not
        known.
    """

    margin: Margin | str
    error: dict[str, IdealError] = field(default_factory=dict)
    lateness: Lateness | None = None
    limits_touched: tuple[str, ...] = ()
    energy_per_cycle: float | None = None

    @property
    def stability(self) -> str:
        """A sentence on stability."""
        if isinstance(self.margin, Margin):
            return self.margin.words
        return f"Stability not determined: {self.margin}"

    @property
    def _brief(self) -> str:
        if isinstance(self.margin, Margin) and not self.margin.stable:
            return self.margin.brief
        return self.stability

    def lines(self, *, warned: bool = False) -> list[str]:
        """For the terminal: stability first, then the error of every dof, its energy, timing and limits.

        Parameters
        ----------
        warned : bool
            Whether the same terminal was told before the test what makes an unstable loop stable.
        """
        left_out = self.margin.left_out if isinstance(self.margin, Margin) else ()
        said = [self._brief if warned else self.stability, *left_out]
        said += [error_words(*one) for one in self.error.items()]
        if self.energy_per_cycle is not None:
            said.append(cycle_words(self.energy_per_cycle))
        if self.lateness is not None:
            said.append(self.lateness.words)
        if self.limits_touched:
            said.append(f"Limits reached: {', '.join(self.limits_touched)}.")
        return said

    def as_dict(self) -> dict[str, object]:
        """``verdict`` of the JSON (contract, section 5)."""
        known = self.margin.as_dict() if isinstance(self.margin, Margin) else {"stable": None}
        return known | {
            "error": {dof: one.as_dict() for dof, one in self.error.items()},
            "timing": self.lateness and self.lateness.as_dict(),
            "limits_touched": list(self.limits_touched),
            "energy_per_cycle": self.energy_per_cycle,
        }


def error_words(dof: str, error: IdealError) -> str:
    """The error of a dof in a sentence."""
    if not error.largest < BEYOND:
        return f"{dof} diverges, as the motion of an unstable loop does."
    if not math.isfinite(error.nrmse):
        return f"{dof} is up to {error.largest:.3g} m from the ideal system, which does not move."
    return (
        f"{dof} differs from the ideal system by {_percent(error.nrmse)} (rms of the ideal motion), by "
        f"{error.largest:.3g} m at most."
    )


def cycle_words(work: float) -> str:
    """The energy per cycle in a sentence.

    Examples
    --------
    >>> cycle_words(-0.0315)
    'Delays, holds and actuator take 0.0315 J out of each cycle of the motion, on average.'
    """
    verb = f"take {abs(work):.3g} J out of" if work < 0.0 else f"put {work:.3g} J into"
    return f"Delays, holds and actuator {verb} each cycle of the motion, on average."


def _percent(part: float) -> str:
    return f"{100.0 * part:.3g} %"
