"""What a free curve says of the missing force, in words: on what, which way, where it was seen."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    CURVE_GAIN,
    CURVE_UNSEEN_SHARE,
    DISSIPATED_SHARE,
    MASS_CHANGE_SHARE,
    MASS_LEFT_RATIO,
    SIMPLER_CURVE_GAIN_SHARE,
    SIMPLER_CURVE_LEFT_RATIO,
    SYMMETRIC_SHARE,
)
from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.missing.binned import binned
from rthm_analysis.diagnosis.missing.curves import CurveFit
from rthm_analysis.diagnosis.missing.motion import Along
from rthm_analysis.diagnosis.numbers import bare, percent
from rthm_analysis.diagnosis.result import Described
from rthm_core.compiled import Floats

VARIABLE_UNITS = {"x": "m", "v": "m/s", "a": "m/s^2", "t": "s", "u": "m", "command": "m", "load": "N"}

NAMES = {
    "x": "the position of {dof}",
    "v": "the velocity of {dof}",
    "a": "the acceleration of {dof}",
    "t": "time",
    "load": "the known load",
}


def is_clear(one: CurveFit) -> bool:
    """Whether a curve removes more than chance does, in data left out of its fit and on unseen ones."""
    return min(one.gain, one.held_out_gain) > CURVE_GAIN


def is_confirmed(one: CurveFit) -> bool:
    """Whether a curve may be told: clear, and a good part of the mismatch on unseen data."""
    return one.held_out_share > CURVE_UNSEEN_SHARE and is_clear(one)


def told(curves: list[CurveFit]) -> CurveFit | None:
    """Curve that is told: the plainest, but for masses that hardly change; None where unconfirmed."""
    return plainest([one for one in curves if not _is_steady_mass(one)])


def plainest(curves: list[CurveFit]) -> CurveFit | None:
    """Curve over the fewest variables that explain as much as any; None where unconfirmed."""
    confirmed = [one for one in curves if is_confirmed(one)]
    if not confirmed:
        return None
    best = max(confirmed, key=_gain_beyond_position)
    left = max(SIMPLER_CURVE_LEFT_RATIO * (best.excess - best.gain), CURVE_GAIN)
    good = [
        one
        for one in confirmed
        if one.gain >= SIMPLER_CURVE_GAIN_SHARE * best.gain and one.excess - one.gain <= left
    ]
    return min([best, *good], key=lambda one: (len(one.feature.depends_on), -one.gain))


def _is_steady_mass(one: CurveFit) -> bool:
    """Whether a curve adds a mass that hardly changes: it makes up for a force, or the spec's is off."""
    mass = one.sizes
    return one.feature.of_mass and float(np.ptp(mass)) < MASS_CHANGE_SHARE * float(np.abs(mass).max())


def _gain_beyond_position(one: CurveFit) -> float:
    """Gain of a curve, less where it is over the acceleration, which goes with the position."""
    left = max(one.excess - one.gain, 0.0)
    return one.excess - left / MASS_LEFT_RATIO if one.feature.of_mass else one.gain


def described(one: CurveFit, interval: tuple[float, float] | None, *, beside: bool) -> Described:
    """A free curve as a finding, maybe beside kinds that were named."""
    variable = one.feature.depends_on[0]
    at, force, std = _drawn(one, getattr(one.at, variable))
    takes = takes_energy(one.force, one.at)
    domain = domain_of(one.at, one.feature.depends_on)
    symmetry = symmetry_of(at, force) if variable in ("x", "v") else "neither"
    words = _words(one, symmetry, takes, interval, domain, "what is left" if beside else "the mismatch")
    return Described(
        "plant", one.site, one.feature.depends_on, symmetry, takes, False, interval, None, domain,
        one.share, one.held_out_share, at, force, std, words,
    )  # fmt: skip


def _drawn(one: CurveFit, over: Floats) -> tuple[Floats, Floats, Floats]:
    """Mean of the force over its first variable."""
    at, force, spread, _ = binned(over, one.force)
    typical = float(np.sqrt(np.mean(np.square(one.stds)))) if one.stds.size else 0.0
    return at, force, np.hypot(spread, typical)


def domain_of(at: Along, depends_on: Iterable[str]) -> dict[str, tuple[float, float]]:
    """Range of each variable but time in which a force was seen."""
    seen = {name: getattr(at, name) for name in depends_on if name != "t"}
    return {name: (float(values.min()), float(values.max())) for name, values in seen.items()}


def symmetry_of(at: Floats, force: Floats) -> str:
    """Whether a curve is ``odd``, ``even`` or ``neither``."""
    reach = min(-float(at.min()), float(at.max()))
    if reach <= 0.0:
        return "neither"
    grid = np.linspace(0.02, 1.0, 40) * reach
    right, left = np.interp(grid, at, force), np.interp(-grid, at, force)
    odd, even = float(np.sum((right - left) ** 2)), float(np.sum((right + left) ** 2))
    share = odd / max(odd + even, 1e-300)
    return "odd" if share > SYMMETRIC_SHARE else "even" if share < 1.0 - SYMMETRIC_SHARE else "neither"


def takes_energy(force: Floats, at: Along) -> bool:
    """Whether a force (s,) takes energy out."""
    power = force * at.v
    return bool(-power.sum() > DISSIPATED_SHARE * np.abs(power).sum())


def ranges_of(domain: dict[str, tuple[float, float]]) -> str:
    """Ranges in words: ``-0.1 to 0.2 m``."""
    return ", ".join(f"{bare(low)} to {bare(high)} {VARIABLE_UNITS[v]}" for v, (low, high) in domain.items())


def law_of(formula: str, depends_on: Iterable[str]) -> str:
    """A formula as a law, with the units of its variables: ``F = 2 * x in N, with x in m``."""
    units = enumerated(f"{name} in {VARIABLE_UNITS[name]}" for name in depends_on)
    return f"F = {formula} in N" + (f", with {units}" if units else "")


def _words(
    one: CurveFit,
    symmetry: str,
    takes: bool,
    interval: tuple[float, float] | None,
    domain: dict[str, tuple[float, float]],
    whole: str,
) -> str:
    names = enumerated(NAMES[v].format(dof=one.site) for v in one.feature.depends_on)
    kind = {"odd": ", of opposite sign on both sides", "even": ", the same on both sides"}.get(symmetry, "")
    when = f" from {bare(interval[0])} s to {bare(interval[1])} s" if interval else ""
    seen = f" (seen from {ranges})" if (ranges := ranges_of(domain)) else ""
    energy = " It takes energy out." if takes else ""
    size = bare(one.largest, 2)
    share = percent(min(one.held_out_share, 1.0))
    mass = f" {_mass_of(one)}" if one.feature.of_mass else ""
    return (
        f"A force of up to {size} N is missing at {one.site}{when} that depends on {names}{seen}{kind}."
        f"{energy}{mass} As a fitted curve it explains {share} of {whole} on unseen data; no kind of the "
        "library fits it beyond doubt."
    )


def _mass_of(one: CurveFit) -> str:
    """What a force over the acceleration is: a mass that changes."""
    first, last = (bare(-float(size), 2) for size in (one.sizes[0], one.sizes[-1]))
    return f"So acts a mass that changes: beyond the spec's it is {first} kg at first and {last} kg at last."
