"""Which free curves are worth a replay: those that the residual force itself looks like."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import (
    CURVE_RIDGE,
    LIKELY_APART_SAMPLES,
    LIKELY_CURVES,
    LIKELY_SAMPLES,
)
from rthm_analysis.diagnosis.missing.features import features
from rthm_analysis.diagnosis.missing.motion import along
from rthm_analysis.diagnosis.missing.residual import residual_force
from rthm_analysis.diagnosis.missing.sites import sites
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_core.compiled import Floats, Integers
from rthm_core.spec import Spec


def likely(experiment: Experiment, windows: Windows, spec: Spec) -> dict[str, frozenset[int]]:
    """Numbers of the features, in their order, that explain most of the residual force at each site, of those
    over its position or its velocity alone, and of the curves behind a straight line over time: that shows no
    shape.

    The force is differentiated from what is left of the motion, so its noise is large: it ranks curves and
    judges none. A site without a position has no entry.
    """
    predicted, motion = experiment.predicted(spec, windows), experiment.motion(spec, windows)
    found = {}
    for site in sites(spec):
        residual = residual_force(experiment.evidence, spec, predicted, site.name)
        if residual is None or not np.isfinite(residual[2]).all():
            continue
        at = along(experiment.evidence, motion, site)
        inside = apart_from_starts(windows, at.t.size)
        asked = inside[:: max(inside.size // LIKELY_SAMPLES, 1)]
        known, force = np.stack([np.ones_like(at.x), at.x, at.v], axis=1)[asked], residual[2][asked]
        every = list(features(at))
        left = [
            np.inf if one.of_mass else _left(np.hstack([known, one.shapes(asked)]), force) for one in every
        ]
        best = np.argsort(left)[:LIKELY_CURVES].tolist()
        besides = {("x",), ("v",), *(every[i].depends_on for i in best if every[i].straight)}
        others = (i for i, one in enumerate(every) if one.depends_on in besides)
        found[site.name] = frozenset([*best, *others])
    return found


def apart_from_starts(windows: Windows, samples: int) -> Integers:
    """Samples apart from where free runs begin: what a model leaves jumps there. All where these are few."""
    near = np.arange(-LIKELY_APART_SAMPLES, LIKELY_APART_SAMPLES)
    jumps = (windows.start[:, None] + near).ravel()
    inside = np.setdiff1d(np.arange(samples), jumps)
    return inside if inside.size > samples // 2 else np.arange(samples)


def _left(columns: Floats, force: Floats) -> float:
    """Squares that columns leave of a force, for each degree of freedom that they leave."""
    scale = np.sqrt(np.mean(np.square(columns), axis=0)) + 1e-300
    scaled = columns / scale
    hessian = scaled.T @ scaled
    ridge = CURVE_RIDGE * np.trace(hessian) * np.eye(scale.size)
    size = np.linalg.solve(hessian + ridge, scaled.T @ force)
    return float(np.sum(np.square(force - scaled @ size)) / max(force.size - scale.size, 1))
