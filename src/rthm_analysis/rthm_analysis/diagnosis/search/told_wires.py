"""A wire whose own force tells what it does, whatever the plant does beside it.

Where two effects are both large, no simulation comes near the recording before both are there. But the force
of a wire follows from the recorded motion of its ends alone.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.replay.model import Model, Parameter
from rthm_analysis.diagnosis.search.candidates import candidates
from rthm_analysis.diagnosis.search.starts import Start
from rthm_core.compiled import Floats
from rthm_core.errors import InputError

SETTLED = 0.02
"""Part of the squared error of a wire's force that may be left along the recorded motion."""

APART = 4.0
"""Times as much as it that every other kind leaves."""

MOST_RUNS = 40
"""Runs along the recorded motion for the fit of one kind."""

DIVERGED = 1e6
"""Residual, over the noise, of a model that diverges."""

TRUSTED = 3.0
"""Factor on a standard deviation for the noise of the recorded motion, which is not in it."""


def told_wire(fitting: Fitting, fitted: Fitted) -> tuple[Start, Model] | None:
    """Effect that explains the force of a wire, and the model with it; None where none or several do."""
    alone = fitting.wires_alone
    if not alone.forces:
        return None
    spec, experiment = fitted.model.spec, alone.experiment
    motion = experiment.motion(spec, alone.windows)
    starts = [
        s for s in candidates(spec, experiment.evidence, motion, fitting.sigma) if s.added.block == "wire"
    ]
    before = _squares(alone.residual(fitted.model))
    if not starts or before == 0.0:
        return None
    models = [s.added_to(fitted.model) for s in starts]
    squares = fitting.cores.each(lambda model: _squares(alone.residual(model)), models)
    best: dict[tuple[str, str], int] = {}
    for i in np.argsort(squares).tolist():
        best.setdefault((starts[i].added.kind, starts[i].added.place), i)
    found = fitting.cores.each(lambda i: _fitted(fitting, fitted.model, models[i]), best.values())
    order = np.argsort([left for left, _ in found]).tolist()
    left, model = found[order[0]]
    others = min((found[i][0] for i in order[1:]), default=np.inf)
    if left > SETTLED * before or others < APART * left:
        return None
    return starts[list(best.values())[order[0]]], model


def _fitted(fitting: Fitting, without: Model, model: Model) -> tuple[float, Model]:
    """Squared error of a wire's force with its effect at its best, and the model; nothing else moves."""
    from scipy.optimize import least_squares

    kept = len(without.parameters)
    own, alone = model.parameters[kept:], fitting.wires_alone
    positive, size = np.array([p.positive for p in own]), np.array([p.value for p in own])
    scale = np.where(positive, size, [p.scale for p in own])

    def at(values: Floats) -> Model:
        moved = np.where(positive, size * np.exp(values), size + values * scale)
        return model.at(np.concatenate([without.values, moved]))

    def residual(values: Floats) -> Floats:
        try:
            return np.nan_to_num(alone.residual(at(values)), nan=DIVERGED, posinf=DIVERGED, neginf=DIVERGED)
        except InputError:
            return np.full(alone.size, DIVERGED)

    done = least_squares(residual, np.zeros(len(own)), method="trf", diff_step=1e-3, max_nfev=MOST_RUNS)
    stds = TRUSTED * scale * np.sqrt(np.diag(np.linalg.pinv(done.jac.T @ done.jac)))
    best = at(done.x)
    held = [_held(p, std) for p, std in zip(best.parameters[kept:], stds.tolist(), strict=True)]
    return 2.0 * float(done.cost), replace(best, parameters=(*without.parameters, *held))


def _held(parameter: Parameter, std: float) -> Parameter:
    """Parameter that stays where the force of the wire wants it."""
    return replace(parameter, prior=(parameter.value, max(std, 1e-6 * abs(parameter.value))))


def released(model: Model, since: int) -> Model:
    """Model whose parameters from number `since` on are held by nothing but the recording."""
    free = (replace(p, prior=None) for p in model.parameters[since:])
    return replace(model, parameters=(*model.parameters[:since], *free))


def _squares(residual: Floats) -> float:
    return float(residual @ residual)
