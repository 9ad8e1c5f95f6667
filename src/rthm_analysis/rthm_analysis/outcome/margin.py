"""How far a loop is from the edge of stability, in its delays."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.lifted.commensurate import period_of
from rthm_analysis.lifted.lifted import Lifted
from rthm_analysis.lifted.linear_part import linear_part
from rthm_analysis.lifted.matrices import linear_loop
from rthm_analysis.stability.edges import delay_edge, scale_edge
from rthm_analysis.stability.limits import DELAYS, can_be_searched
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_core.spec import Spec

SEARCHED = 10.0
"""Factor on each delay up to which its edge is looked for: a margin beyond it is ample."""


UNSEARCHED = "Delay margin not computed: the delays span too many sampling periods."


@dataclass(frozen=True)
class Margin:
    """Stability of the linear part of a loop, and the delays at which it is first lost.

    Attributes
    ----------
    spectral_radius : float
        Largest modulus of the eigenvalues over `hyperperiod` (s).
    scale : float or None
        Factor on all periods and delays at which stability is first lost as it grows from zero; None: nowhere
        up to 100.
    delays : dict
        By name, nominal value and the value at which stability is first lost where it alone is changed, s;
        None: not up to `SEARCHED` times its value.
    left_out : tuple of str
        What is not linear and was left out, a sentence each.
    searched : bool
        Whether the edge was searched at all; not where very many samples are in transit.
    """

    spectral_radius: float
    hyperperiod: float
    scale: float | None
    delays: dict[str, tuple[float, float | None]]
    left_out: tuple[str, ...] = ()
    searched: bool = True

    @property
    def stable(self) -> bool:
        """Whether every free motion fades."""
        return self.spectral_radius < 1.0

    @property
    def doubling_time(self) -> float | None:
        """Time in which the motion of a loop that is not stable doubles, s; None: it is stable."""
        growth = math.log(self.spectral_radius) / self.hyperperiod
        return math.log(2.0) / growth if growth > 0.0 else None

    @property
    def nearest(self) -> tuple[str, float, float] | None:
        """The delay whose edge is nearest in proportion: name, value and edge, s; None: there is none."""
        found = [(name, value, edge) for name, (value, edge) in self.delays.items() if edge is not None]
        if not self.stable:
            found = [one for one in found if 0.0 < one[2] < one[1]]
        return min(found, key=lambda one: abs(one[2] / one[1] - 1.0) if one[1] else np.inf, default=None)

    @property
    def words(self) -> str:
        """Whether the loop is stable, and how far its edge is or what makes it stable."""
        return self._stable_words() if self.stable else f"{self.brief} {self._remedy()}"

    @property
    def brief(self) -> str:
        """Whether the loop is stable; how fast it grows where it is not."""
        time = self.doubling_time
        return "Stable." if time is None else f"Unstable: a small motion doubles every {time:.3g} s."

    def _stable_words(self) -> str:
        if not self.searched:
            return f"Stable. {UNSEARCHED}"
        margins = []
        if self.scale is not None:
            margins.append(("all periods and delays", self.scale > 1.0, _fold(self.scale)))
        if self.nearest is not None:
            name, nominal, edge = self.nearest
            margins.append((f"{name} alone", edge > nominal, f" from {_change(nominal, edge)}"))
        return f"Stable{_could(margins) or f', even with any one delay {SEARCHED:g} times as long'}."

    def _remedy(self) -> str:
        """What makes a loop stable that is not, as far as it is known."""
        if not self.searched:
            return UNSEARCHED
        ways = []
        if self.scale is not None and self.scale > 0.0:
            ways.append(f"below {self.scale:.3g} times its periods and delays")
        if self.nearest is not None:
            name, nominal, edge = self.nearest
            ways.append(f"with {name} below {_ms(edge)} ms (now {_ms(nominal)} ms)")
        return f"It is stable {', or '.join(ways)}." if ways else "No delay alone makes it stable."

    def as_dict(self) -> dict[str, object]:
        """Keys of ``verdict`` in the JSON (contract, section 5)."""
        return {
            "stable": self.stable,
            "spectral_radius": self.spectral_radius,
            "delay_margin": self.scale,
            "doubling_time": self.doubling_time,
            "delays": {
                name: {"nominal": nominal, "critical": edge} for name, (nominal, edge) in self.delays.items()
            },
            "left_out": list(self.left_out),
        }


def _could(margins: list[tuple[str, bool, str]]) -> str:
    """What could change before stability is lost: its name, whether it grows, and how far."""
    said, before = [], None
    for name, grows, far in margins:
        verb = " could grow" if grows else " could shrink"
        said.append(f"{name}{verb if verb != before else ''}{far}")
        before = verb
    return f"; {', or '.join(said)}" if said else ""


def _fold(factor: float) -> str:
    return f" {factor:.3g}-fold" if factor > 1.0 else f" to {factor:.3g} of their values"


def _change(nominal: float, edge: float) -> str:
    """From one time to another, with digits enough to distinguish them."""
    close = f"{nominal:.3g}" == f"{edge:.3g}"
    return f"{_ms(nominal, 6 if close else 3)} to {_ms(edge, 6 if close else 3)} ms"


def _ms(seconds: float, digits: int = 3) -> str:
    return f"{1e3 * seconds:.{digits}g}"


def margin_of(spec: Spec) -> Margin:
    """Stability of a loop and its margin in every delay.

    Raises
    ------
    InputError
        When the spec describes no loop, or has a compensator whose linear equations are not known.

    Examples
    --------
    >>> from rthm_core.spec import shipped_spec
    >>> margin_of(shipped_spec("paper")).words
    'Stable; all periods and delays could grow 21.2-fold, or tau3 alone from 12 to 81.6 ms.'
    """
    linear, left_out = linear_part(spec)
    loop, (cycle, _) = linear_loop(linear), period_of(linear)
    monodromy = Lifted(loop, cycle).monodromy()
    radius = float(np.abs(np.linalg.eigvals(monodromy)).max())
    if not can_be_searched(cycle):
        return Margin(radius, cycle.hyperperiod, None, {}, left_out, searched=False)
    timing = linear.loop().timing
    delays = {
        name: (float(getattr(timing, name)), delay_edge(linear, loop, name, SEARCHED)) for name in DELAYS
    }
    return Margin(radius, cycle.hyperperiod, scale_edge(linear, loop, cycle), delays, left_out)


def margin_or_why(spec: Spec) -> Margin | str:
    """Margin of a loop, or why it is not known."""
    try:
        return margin_of(spec)
    except InputError as error:
        return str(error)
