"""Stability of a loop."""

from __future__ import annotations

from dataclasses import dataclass, field

from rthm_analysis.stability.limits import Limit
from rthm_analysis.stability.modes import Mode


@dataclass(frozen=True)
class Stability:
    """What is known of the stability of a loop.

    Attributes
    ----------
    spectral_radius : float
        Largest modulus of the eigenvalues over `hyperperiod` (s); below 1 the loop is stable.
    modes : tuple of Mode
        The one that fades most slowly first.
    period_error : float
        Relative error of the periods of clocks that never tick together; 0: exact.
    left_out : tuple of str
        What is not linear and was left out, a sentence each.
    k_tot : tuple of float
        Of every actuator, N/m.
    limits : dict of Limit
        ``scale`` (all periods and delays), ``k_tot`` (factor), and every delay and period by its name.
    """

    spectral_radius: float
    hyperperiod: float
    modes: tuple[Mode, ...]
    period_error: float
    left_out: tuple[str, ...]
    k_tot: tuple[float, ...]
    limits: dict[str, Limit] = field(default_factory=dict)

    @property
    def stable(self) -> bool:
        """Whether every free motion fades."""
        return self.spectral_radius < 1.0

    @property
    def k_tot_limits(self) -> tuple[float | None, float | None]:
        """Factors on k_tot between which the loop is stable as far as its own k_tot is; None: no limit found,
        or not stable.
        """
        if not self.stable or "k_tot" not in self.limits:
            return None, None
        return self.limits["k_tot"].scan.around(1.0)

    def as_dict(self) -> dict[str, object]:
        """Contract, section 5: keys of ``rthm stability --json``, and more."""
        scale = self.limits.get("scale")
        lower, upper = (self._k_tot(factor) for factor in self.k_tot_limits)
        return {
            "stable": self.stable,
            "spectral_radius": self.spectral_radius,
            "hyperperiod": self.hyperperiod,
            "critical_scale": scale.critical_scale if scale else None,
            "modes": [mode.as_dict() for mode in self.modes],
            "crossings": scale.as_dict()["crossings"] if scale else [],
            "k_tot": {"lower": lower, "upper": upper},
            "limits": {name: limit.as_dict() for name, limit in self.limits.items()},
            "exact": self.period_error == 0.0,
            "period_error": self.period_error,
            "left_out": list(self.left_out),
        }

    def _k_tot(self, factor: float | None) -> list[float] | float | None:
        values = None if factor is None else [factor * k for k in self.k_tot]
        return values[0] if values is not None and len(values) == 1 else values
