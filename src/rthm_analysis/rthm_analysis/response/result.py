"""Frequency response of a loop, five ways."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.lifted.commensurate import period_of
from rthm_analysis.lifted.lifted import Lifted
from rthm_analysis.lifted.linear_part import linear_part
from rthm_analysis.lifted.matrices import linear_loop
from rthm_analysis.response.margins import LoopTransfer, Margins, margins_of
from rthm_analysis.response.models import Complex, coupled, delayed, paths
from rthm_analysis.response.sampled import sampled
from rthm_core.compiled import Floats
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_core.spec import Spec

WAYS = ("ideal", "delays", "delays_and_holds", "taylor", "sampled")


@dataclass(frozen=True)
class Response:
    """Response from loads to positions.

    Attributes
    ----------
    omega : (W,) array
        rad/s.
    dofs : tuple of str
        Plant dofs, then numerical dofs (N in all): inputs and outputs.
    ways : dict of (W, N, N) arrays
        By way, ``[frequency, output, input]``, m/N; the phase is that of the motion against the load.
    stable : bool
        Whether the sampled loop is stable; else nothing settles, and its column is what would be.
    period_error : float
        Relative error of the periods of clocks that never tick together; 0: exact.
    left_out : tuple of str
        What is not linear and was left out, a sentence each.
    margins : tuple of Margins
        Of the way ``delays_and_holds``, cut at the command of each motor; without figures where that is not
        stable.
    loop_transfer : (W, m) array or None
        What becomes of each motor's command once round the loop, in the same way.
    """

    omega: Floats
    dofs: tuple[str, ...]
    ways: dict[str, Complex]
    stable: bool
    period_error: float
    left_out: tuple[str, ...]
    margins: tuple[Margins, ...] = ()
    loop_transfer: Complex | None = None

    def as_dict(self) -> dict[str, object]:
        """Contract, section 5: keys of ``rthm response --json``."""
        rows = [
            {
                "omega": float(w),
                "input": self.dofs[i],
                "output": self.dofs[o],
                **{way: _polar(complex(values[k, o, i])) for way, values in self.ways.items()},
            }
            for k, w in enumerate(self.omega)
            for i in range(len(self.dofs))
            for o in range(len(self.dofs))
        ]
        return {
            "response": rows,
            "stable": self.stable,
            "period_error": self.period_error,
            "left_out": list(self.left_out),
            "margins": [one.as_dict() for one in self.margins],
        }


def _polar(value: complex) -> dict[str, float]:
    return {"amplitude": abs(value), "phase_deg": float(np.angle(value, deg=True))}


def response(spec: Spec, omega: Floats) -> Response:
    """Frequency response of a loop's linear part, five ways.

    Parameters
    ----------
    spec : Spec
        A complete loop.
    omega : (W,) array
        Frequencies, rad/s, positive.

    Raises
    ------
    InputError
        When the spec describes no loop, or a frequency is not positive.
    """
    omega = np.atleast_1d(np.asarray(omega, dtype=float))
    if omega.size == 0 or not np.all(np.isfinite(omega) & (omega > 0.0)):
        raise InputError(
            f"omega is {omega.tolist()}, but must be positive, finite frequencies in rad/s; correct it."
        )
    linear, left_out = linear_part(spec)
    loop, (cycle, error) = linear_loop(linear), period_of(linear)
    lifted, held = Lifted(loop, cycle), paths(linear, holds=True)
    transfer = LoopTransfer(loop, held)
    ways = {
        "ideal": coupled(linear, "ideal", omega),
        "delays": delayed(loop, paths(linear, holds=False), omega),
        "delays_and_holds": delayed(loop, held, omega),
        "taylor": coupled(linear, "taylor", omega),
        "sampled": sampled(lifted, omega),
    }
    if loop.predictor is not None:
        how = spec.loop().actuator.compensator
        left_out = (
            *left_out,
            f"The compensator ({how}) is included in the column sampled, but not in the margins.",
        )
    stable = bool(np.abs(np.linalg.eigvals(lifted.monodromy())).max() < 1.0)
    dofs = (*spec.plant.dofs, *spec.loop().numerical.dofs)
    margins = margins_of(transfer, spec.loop().actuator.names)
    return Response(omega, dofs, ways, stable, error, left_out, margins, transfer(omega))
