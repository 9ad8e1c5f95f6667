"""The force that the retuned model lacks, drawn over the variable that explains it best.

The residual motion, smoothed just enough, gives the force that would have made it. Averages over many
samples at the same abscissa let the noise drown.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from rthm_analysis.diagnosis.physical import Physical
from rthm_analysis.diagnosis.result import Curve, Physics
from rthm_core.compiled import Floats

BINS = 40
SMOOTHING = 9
"""Samples of the parabola through which the residual motion is differentiated."""


def force_curve(physical: Physical, predicted: Floats, physics: Sequence[Physics]) -> Iterator[Curve]:
    """Residual force on each dof over x, v or t, whichever it depends on most; none without a mismatch."""
    spec = physical.settled
    assert spec.plant is not None
    for dof in spec.plant.dofs:
        found = residual_force(physical, predicted, dof)
        if found is None:
            continue
        x, v, force = found
        variables = {"x": (x, "m"), "v": (v, "m/s"), "t": (physical.evidence.time, "s")}
        binned = {name: _binned(values, force) for name, (values, _) in variables.items()}
        best = max(binned, key=lambda name: binned[name][3])
        at, mean, std, share = binned[best]
        if share > 0.02 or any(one.block == "plant" for one in physics):
            yield Curve("plant", best, variables[best][1], at, mean, std, None, share)


def residual_force(physical: Physical, predicted: Floats, dof: str) -> tuple[Floats, Floats, Floats] | None:
    """Measured position and velocity of a dof, and the force that the model lacks there: (s,) each."""
    from scipy.signal import savgol_filter

    spec, evidence = physical.settled, physical.evidence
    assert spec.plant is not None
    i, n = spec.plant.dofs.index(dof), len(spec.plant.dofs)
    channels = {(c.family, c.place): k for k, c in enumerate(evidence.channels)}
    where = channels.get(("position", dof))
    if where is None or evidence.stamps_ns.size < 10 * SMOOTHING:
        return None
    step = float(np.median(np.diff(evidence.time)))
    left = np.nan_to_num(evidence.measured - predicted)
    x = np.nan_to_num(evidence.measured[:, where])
    speed = channels.get(("velocity", dof))
    width = SMOOTHING if speed is not None else 4 * SMOOTHING + 1
    dx = savgol_filter(left[:, where], width, 2)
    dv = left[:, speed] if speed is not None else savgol_filter(left[:, where], width, 2, 1, step)
    da = (
        savgol_filter(left[:, speed], width, 2, 1, step)
        if speed is not None
        else savgol_filter(left[:, where], width, 2, 2, step)
    )
    v = (
        np.nan_to_num(evidence.measured[:, speed])
        if speed is not None
        else savgol_filter(x, width, 2, 1, step)
    )
    mass, damping, stiffness = (
        float(getattr(spec.plant, p)[i * n + i]) for p in ("mass", "damping", "stiffness")
    )
    pull = 0.0
    if spec.interface is not None and spec.actuator is not None and evidence.driven_by == "command":
        pull = sum(k for k, at in zip(spec.k_tot, spec.interface.plant_dof, strict=True) if at == dof)
    return x, v, mass * da + damping * dv + (stiffness + pull) * dx


def _binned(values: Floats, force: Floats) -> tuple[Floats, Floats, Floats, float]:
    """Abscissa, mean force, its standard deviation, and the part of the variance that the means explain."""
    edges = np.quantile(values, np.linspace(0.0, 1.0, BINS + 1))
    number = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, BINS - 1)
    count = np.maximum(np.bincount(number, minlength=BINS), 1)
    at = np.bincount(number, values, BINS) / count
    mean = np.bincount(number, force, BINS) / count
    spread = np.sqrt(np.maximum(np.bincount(number, force**2, BINS) / count - mean**2, 0.0) / count)
    share = float(np.var(mean[number]) / max(float(np.var(force)), 1e-300))
    used = np.bincount(number, minlength=BINS) > 0
    return at[used], mean[used], spread[used], share
