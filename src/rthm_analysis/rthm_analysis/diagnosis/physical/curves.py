"""The force that the retuned model lacks, drawn over the variable that explains it best.

The motion that the best model leaves, smoothed just enough, gives the force that would have made it. With
the force of what was named added, this is what the data say about the named physics, whatever they say.
Averages over many samples at the same abscissa let the noise drown.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import DRAWN_CURVE_SHARE, RESIDUAL_PARABOLA_SAMPLES
from rthm_analysis.diagnosis.missing.binned import binned, spread_over
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.physical.work import law_force
from rthm_analysis.diagnosis.result import Curve, Physics
from rthm_core.compiled import Floats
from rthm_core.spec.sections import MATRICES


def force_curve(physical: Physical, predicted: Floats, physics: Sequence[Physics]) -> Iterator[Curve]:
    """Missing force on each dof over x, v or t, whichever it depends on most; none without a mismatch.

    `predicted` is the prediction of the best model.
    """
    spec = physical.settled
    assert spec.plant is not None
    for dof in spec.plant.dofs:
        found = residual_force(physical, predicted, dof)
        if found is None:
            continue
        x, v, left = found
        named = named_force(physical, dof, x, v)
        force = left if named is None else left + named
        variables = {"x": (x, "m"), "v": (v, "m/s"), "t": (physical.evidence.time, "s")}
        curves = {name: binned(values, force) for name, (values, _) in variables.items()}
        best = max(curves, key=lambda name: curves[name][3])
        at, mean, std, share = curves[best]
        if share > DRAWN_CURVE_SHARE or any(one.block == "plant" for one in physics):
            over, unit = variables[best]
            law = None if named is None else spread_over(over, named)
            yield Curve("plant", best, unit, at, mean, std, law, share)


def named_force(physical: Physical, dof: str, x: Floats, v: Floats) -> Floats | None:
    """Force (s,) of the effects that were named on a dof, along the measured motion; None without any."""
    model = physical.selection.best.model
    names = {model.name(i) for i, one in enumerate(model.added) if one.block == "plant" and one.place == dof}
    effects = [one for one in model.spec.effects if one.name in names]
    if not effects:
        return None
    return np.asarray(np.sum([law_force(one, physical.evidence.time, x, v) for one in effects], axis=0))


def residual_force(physical: Physical, predicted: Floats, dof: str) -> tuple[Floats, Floats, Floats] | None:
    """Measured position and velocity of a dof, and the force that the model lacks there: (s,) each."""
    spec, evidence = physical.settled, physical.evidence
    assert spec.plant is not None
    i, n = spec.plant.dofs.index(dof), len(spec.plant.dofs)
    channels = {(c.family, c.place): k for k, c in enumerate(evidence.channels)}
    where = channels.get(("position", dof))
    if where is None or evidence.stamps_ns.size < 10 * RESIDUAL_PARABOLA_SAMPLES:
        return None
    step = float(np.median(np.diff(evidence.time)))
    left = np.nan_to_num(evidence.measured - predicted)
    x = np.nan_to_num(evidence.measured[:, where])
    speed = channels.get(("velocity", dof))
    width = RESIDUAL_PARABOLA_SAMPLES if speed is not None else 4 * RESIDUAL_PARABOLA_SAMPLES + 1
    dx = _smoothed(left[:, where], width)
    if speed is not None:
        v, dv = np.nan_to_num(evidence.measured[:, speed]), left[:, speed]
        da = _smoothed(dv, width, 1) / step
    else:
        v, dv = _smoothed(x, width, 1) / step, _smoothed(left[:, where], width, 1) / step
        da = _smoothed(left[:, where], width, 2) / step**2
    mass, damping, stiffness = (float(getattr(spec.plant, name)[i * n + i]) for name in MATRICES)
    pull = 0.0
    if spec.interface is not None and spec.actuator is not None and evidence.driven_by == "command":
        pull = sum(k for k, at in zip(spec.k_tot, spec.interface.plant_dof, strict=True) if at == dof)
    return x, v, mass * da + damping * dv + (stiffness + pull) * dx


def _smoothed(values: Floats, width: int, order: int = 0) -> Floats:
    """Derivative with respect to the sample of the parabolas through `width` samples, in their middles; the
    first and the last parabola hold up to the ends (Savitzky and Golay).
    """
    half = width // 2
    powers = np.vander(np.arange(-half, half + 1.0), 3, increasing=True)
    fits = np.linalg.pinv(powers)
    smooth = np.empty_like(values)
    weights = fits[order] * (2.0 if order == 2 else 1.0)
    smooth[half : values.size - half] = np.convolve(values, weights[::-1], "valid")
    for samples, at in ((slice(0, width), slice(0, half)), (slice(-width, None), slice(-half, None))):
        derivative = np.polynomial.polynomial.polyder(fits @ values[samples], order)
        smooth[at] = np.polynomial.polynomial.polyval(powers[at, 1], derivative)
    return smooth
