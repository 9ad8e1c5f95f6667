"""A wire whose own force tells what it does, whatever the plant does beside it.

Where two effects are both large, no simulation comes near the recording before both are there. But the force
of a wire follows from the recorded motion of its ends alone.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.fitting.wires_alone import WiresAlone
from rthm_analysis.diagnosis.replay.model import Model, Parameter
from rthm_analysis.diagnosis.search.candidates import candidates
from rthm_analysis.diagnosis.search.starts import Start
from rthm_core.compiled import Floats
from rthm_core.errors import InputError

LEFT, APART = 0.25, 4.0
"""Part of the squared error of a wire's force that may be left along the recorded motion, and how many times
as much every other kind leaves.
"""

SETTLED, WHITE = 0.02, 1.5
"""Part that is as good as nothing, and how many times its white part something may be that is only noise."""

ROUGH, FINE = 6, 40
"""Runs along the recorded motion for a first fit of every kind, and for the fit of the best."""

DIVERGED = 1e6
"""Residual, over the noise, of a model that diverges."""

TRUSTED = 3.0
"""Factor on a standard deviation for the noise of the recorded motion, which is not in it."""


def told_wire(fitting: Fitting, fitted: Fitted) -> tuple[Start, Model] | None:
    """Effect that explains the force of a wire, and the model with it; None where none or several do."""
    alone, without = fitting.wires_alone, fitted.model
    if not alone.forces:
        return None
    here = alone.residual(without)
    before = _squares(here)
    if before < WHITE * _white(here, alone):
        return None
    best = _best_starts(fitting, without)
    found = fitting.cores.each(lambda start: _fitted(fitting, without, start.added_to(without), ROUGH), best)
    order = sorted(range(len(best)), key=lambda i: found[i][0])
    if not order:
        return None
    others = min((found[i][0] for i in order[1:]), default=np.inf)
    free = released(found[order[0]][1], len(without.parameters))
    left, model = _fitted(fitting, without, free, FINE)
    noise = WHITE * _white(alone.residual(model), alone)
    if left > LEFT * before or others < APART * left or left > max(SETTLED * before, noise):
        return None
    return best[order[0]], model


def _best_starts(fitting: Fitting, model: Model) -> list[Start]:
    """Best start of each kind in each wire."""
    alone, spec = fitting.wires_alone, model.spec
    experiment = alone.experiment
    motion = experiment.motion(spec, alone.windows)
    found = candidates(spec, experiment.evidence, motion, fitting.sigma)
    starts = [start for start in found if start.added.block == "wire"]
    squares = fitting.cores.each(lambda start: _squares(alone.residual(start.added_to(model))), starts)
    best: dict[tuple[str, str], Start] = {}
    for i in np.argsort(squares).tolist():
        best.setdefault((starts[i].added.kind, starts[i].added.place), starts[i])
    return list(best.values())


def _fitted(fitting: Fitting, without: Model, model: Model, most: int) -> tuple[float, Model]:
    """Squared error of a wire's force with its effect at its best, and the model; nothing else moves."""
    from scipy.optimize import least_squares

    kept = len(without.parameters)
    own, alone = model.parameters[kept:], fitting.wires_alone
    positive, size = np.array([p.positive for p in own]), np.array([p.value for p in own])
    scale = np.where(positive, size, [p.scale for p in own])

    def at(values: Floats) -> Model:
        moved = np.where(positive, size * np.exp(values - 1.0), size + (values - 1.0) * scale)
        return model.at(np.concatenate([without.values, moved]))

    def residual(values: Floats) -> Floats:
        try:
            return np.clip(np.nan_to_num(alone.residual(at(values)), nan=DIVERGED), -DIVERGED, DIVERGED)
        except InputError:
            return np.full(alone.size, DIVERGED)

    done = least_squares(residual, np.ones(len(own)), method="trf", diff_step=1e-3, max_nfev=most)
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


def _white(residual: Floats, alone: WiresAlone) -> float:
    """Squared error that white noise with the differences of a residual from sample to sample would have."""
    columns = residual.reshape(-1, len(alone.forces))
    return 0.5 * float(np.square(np.diff(columns, axis=0)).sum())
