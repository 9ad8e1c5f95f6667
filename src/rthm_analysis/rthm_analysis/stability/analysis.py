"""From a spec to its stability."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.lifted.commensurate import period_of
from rthm_analysis.lifted.cycle import Cycle
from rthm_analysis.lifted.lifted import Lifted
from rthm_analysis.lifted.linear_part import linear_part
from rthm_analysis.lifted.matrices import LinearLoop, linear_loop
from rthm_analysis.stability.limits import (
    DELAYS,
    PERIODS,
    Limit,
    check_searchable,
    delay_limit,
    k_tot_limit,
    period_limit,
    scale_limit,
)
from rthm_analysis.stability.modes import Mode, modes
from rthm_analysis.stability.result import Stability
from rthm_core.compiled import Floats

if TYPE_CHECKING:
    from rthm_core.spec import Spec

Progress = Callable[[float], None]


def spectral_radius(spec: Spec) -> float:
    """Largest modulus of a loop's eigenvalues over one hyperperiod; below 1 it is stable.

    Raises
    ------
    InputError
        When the spec describes no loop, or has a compensator whose linear equations are not known.
    """
    return _radius(_lifted(spec).monodromy())


class Slowest(NamedTuple):
    """Spectral radius of a loop over one `hyperperiod` (s), and the mode that fades most slowly."""

    spectral_radius: float
    hyperperiod: float
    mode: Mode


def slowest(spec: Spec) -> Slowest:
    """What of `stability` belongs to the slowest mode; it raises the same errors."""
    lifted = _lifted(spec)
    monodromy = lifted.monodromy()
    return Slowest(_radius(monodromy), lifted.cycle.hyperperiod, modes(lifted, monodromy, 1)[0])


def _lifted(spec: Spec) -> Lifted:
    """Linear part of a loop along its cycle."""
    linear, _ = linear_part(spec)
    return Lifted(linear_loop(linear), period_of(linear).cycle)


def _radius(monodromy: Floats) -> float:
    return float(np.abs(np.linalg.eigvals(monodromy)).max())


def stability(spec: Spec, *, limits: bool = True, progress: Progress | None = None) -> Stability:
    """Exact stability of a loop's linear part, with its modes and, if asked for, all its limits.

    Parameters
    ----------
    spec : Spec
        A complete loop.
    limits : bool
        Whether crossings are searched.
    progress : callable, optional
        Called with the number of searches done, out of `searches`.

    Raises
    ------
    InputError
        When the spec describes no loop, has a compensator whose linear equations are not known, or delays
        too long for a search.
    """
    linear, left_out = linear_part(spec)
    loop, (cycle, error) = linear_loop(linear), period_of(linear)
    if limits:
        check_searchable(cycle)
    lifted = Lifted(loop, cycle)
    monodromy = lifted.monodromy()
    return Stability(
        _radius(monodromy),
        cycle.hyperperiod,
        modes(lifted, monodromy),
        error,
        left_out,
        tuple(spec.k_tot),
        _limits(linear, loop, cycle, progress or (lambda done: None)) if limits else {},
    )


SEARCHES = 2 + len(DELAYS) + len(PERIODS)
"""Number of searches of a whole analysis."""


def _limits(spec: Spec, loop: LinearLoop, cycle: Cycle, progress: Progress) -> dict[str, Limit]:
    found: dict[str, Limit | None] = {"scale": scale_limit(spec, loop, cycle)}
    progress(1.0)
    found["k_tot"] = k_tot_limit(spec, cycle)
    progress(2.0)
    for done, name in enumerate((*DELAYS, *PERIODS), 3):
        one = delay_limit if name in DELAYS else period_limit
        found[name] = one(spec, loop, name)
        progress(float(done))
    return {name: limit for name, limit in found.items() if limit is not None}
