"""What is said of a loop before it begins: that it is unstable, if it is."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from rthm_analysis.outcome import Margin, margin_of, margin_or_why
from rthm_analysis.stability import spectral_radius
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_core.spec import Spec


def is_unstable(spec: Spec) -> bool:
    """Whether a spec is that of a loop which is known to be unstable; then that is told on standard error."""
    try:
        if not spec.is_loop or spectral_radius(spec) < 1.0:
            return False
        _tell(margin_of(spec))
    except InputError:  # of what the compensator does no linear equations are known
        return False
    return True


def _tell(margin: Margin) -> None:
    print("rthm:", margin.words, file=sys.stderr, flush=True)


def told_margin(spec: Spec) -> Margin | str:
    """Margin of a loop, or why it is not known; one that is unstable is told at once on standard error."""
    margin = margin_or_why(spec)
    if isinstance(margin, Margin) and not margin.stable:
        _tell(margin)
    return margin
