"""Steps of a fit: damped, by factors where a parameter is positive, none across a bound."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import LARGEST_LOG_STEP
from rthm_analysis.diagnosis.fitting.sums import Sums
from rthm_analysis.diagnosis.replay.model import Model, Parameter
from rthm_core.compiled import Floats


def moved(model: Model, sums: Sums, damping: float) -> Floats:
    """Values after a damped step; what is positive moves by factors, and stays positive.

    Raises
    ------
    LinAlgError
        If the model diverges. LAPACK would write that to standard output, where answers go.
    """
    values, directions = model.values, _directions(model)
    positive = np.array([p.positive for p in model.parameters])
    whole = directions.T @ (sums.hessian.sum(0) + np.diag(sums.precision)) @ directions
    gradient = directions.T @ (sums.gradient.sum(0) + sums.pull)
    stuck = np.array([_leaves(p, g) for p, g in zip(model.parameters, gradient, strict=True)])
    diagonal = np.diag(whole).copy()
    whole += np.diag(damping * diagonal + 1e-12 * max(float(diagonal.max(initial=0.0)), 1e-300))
    whole[stuck], whole[:, stuck] = 0.0, 0.0
    whole[stuck, stuck] = 1.0
    if not (np.isfinite(whole).all() and np.isfinite(gradient).all()):
        raise np.linalg.LinAlgError("a diverging model has no next step")
    step = np.linalg.lstsq(whole, np.where(stuck, 0.0, gradient), rcond=1e-14)[0]
    factor = np.exp(np.clip(step, -LARGEST_LOG_STEP, LARGEST_LOG_STEP))
    stepped = np.where(positive, values * factor, values + step * np.diag(directions))
    for i, p in enumerate(model.parameters):
        if p.along is not None:
            stepped[i] *= factor[p.along]
    return np.asarray(stepped)


def _directions(model: Model) -> Floats:
    """Change of the parameters (p, p) with the steps of a fit.

    What is positive moves by factors; what moves along with another keeps its ratio to it.
    """
    scale = [p.value if p.positive else p.scale for p in model.parameters]
    directions = np.diag(np.array(scale, dtype=float))
    for i, p in enumerate(model.parameters):
        if p.along is not None:
            directions[i, p.along] = p.value
    return directions


def _leaves(parameter: Parameter, gradient: float) -> bool:
    """Whether a parameter at a bound wants to leave it."""
    low, high = parameter.value <= parameter.low, parameter.value >= parameter.high
    return (low and gradient < 0.0) or (high and gradient > 0.0)


def trial_step(parameter: Parameter, small: float) -> float:
    """Step of a finite difference, so small a part of the parameter's size, towards what is possible."""
    step = small * (parameter.value if parameter.positive else parameter.scale)
    return -step if parameter.value + step > parameter.high else step
