"""What is said of a loop before it begins: that it is unstable, or that a delay is longer than its motion."""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING

from rthm_analysis.lifted.cycle import TooManySamplesError
from rthm_analysis.outcome import Margin, margin_of, margin_or_why
from rthm_analysis.stability import spectral_radius
from rthm_analysis.stability.limits import DELAYS
from rthm_core.engine.coupled.body import coupled_body
from rthm_core.errors import InputError
from rthm_core.substructure import natural_frequencies

if TYPE_CHECKING:
    from rthm_core.spec import Spec


def long_delays(spec: Spec) -> tuple[str, ...]:
    """A sentence about every delay that is longer than a period of the slowest motion of the ideal system.

    No test has such delays on purpose, and whoever means milliseconds writes them.

    Examples
    --------
    >>> from rthm_core.spec import apply, shipped_spec
    >>> long_delays(apply(shipped_spec("paper"), {"timing.tau4": 10.0}))
    ('timing.tau4 is 10 s, 3.84 periods of the motion (2.6 s); write 0.01 if milliseconds are meant.',)
    """
    if not spec.is_loop:
        return ()
    body = coupled_body(spec, "ideal")
    slowest = float(natural_frequencies(body.mass, body.stiffness)[0])
    period = 2.0 * math.pi / slowest if slowest else math.inf
    delays = ((name, value) for name, value in spec.loop().timing.items() if name in DELAYS)
    return tuple(
        f"timing.{name} is {value:g} s, {value / period:.3g} periods of the motion ({period:.3g} s); "
        f"write {1e-3 * value:g} if milliseconds are meant."
        for name, value in delays
        if value > period
    )


def refuse(spec: Spec) -> None:
    """Move no real machine by a loop that is unstable, or has a delay longer than its motion.

    Raises
    ------
    InputError
        With the reason and the way out in one line.
    """
    late = long_delays(spec)
    if late:
        raise InputError(
            f"{' '.join(late)} The machine will not be moved; correct it, or pass --unstable to run it "
            "anyway."
        )
    margin = _unstable_margin(spec)
    if margin is not None:
        raise InputError(
            f"{margin.words} The machine will not be moved; change the delays, or pass --unstable to run it "
            "anyway."
        )


def warn_of_delays(spec: Spec) -> None:
    """Print `long_delays` to standard error."""
    for sentence in long_delays(spec):
        print("rthm: warning:", sentence, file=sys.stderr, flush=True)


def warn_of_growth(spec: Spec) -> None:
    """Say on standard error that a loop is unstable, where it is known to be."""
    margin = _unstable_margin(spec)
    if margin is not None:
        _print(margin)


def _unstable_margin(spec: Spec) -> Margin | None:
    """Margin of a loop that is known to be unstable; None: it is stable, not known, or no loop."""
    try:
        return margin_of(spec) if spec.is_loop and spectral_radius(spec) >= 1.0 else None
    except TooManySamplesError:  # a loop that may be unstable moves nothing
        raise
    except InputError:  # of what the compensator does no linear equations are known
        return None


def _print(margin: Margin) -> None:
    print("rthm:", margin.words, file=sys.stderr, flush=True)


def told_margin(spec: Spec) -> Margin | str:
    """Margin of a loop, or why it is not known; one that is unstable is reported at once on stderr."""
    warn_of_delays(spec)
    margin = margin_or_why(spec)
    if isinstance(margin, Margin) and not margin.stable:
        _print(margin)
    return margin
