"""A wire whose own force tells what it does, whatever the plant does beside it.

Where two effects are both large, no simulation comes near the recording before both are there. But the force
of a wire follows from the recorded motion of its ends alone.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.fitting.fitting import DIVERGED, Fitted, Fitting, bounded
from rthm_analysis.diagnosis.fitting.wires_alone import WiresAlone
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.candidates import candidates
from rthm_analysis.diagnosis.search.starts import Start
from rthm_core.compiled import Floats
from rthm_core.errors import InputError

LEFT, APART = 0.25, 4.0
"""Part of the squared error of a wire's force that may be left along the recorded motion, and how many times
as much every other kind leaves; what is noise counts on neither side.
"""

SETTLED, WHITE = 0.02, 1.5
"""Part that is as good as nothing, and how many times its white part something may be that is only noise."""

ROUGH, FINE = 6, 40
"""Runs along the recorded motion for a first fit of every kind, and for the fit of the best."""

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
    rough = fitting.cores.each(lambda start: _fitted(alone, without, start.added_to(without), ROUGH), best)
    if not rough:
        return None
    order = sorted(range(len(best)), key=lambda i: rough[i].left)
    others = min((rough[i].left for i in order[1:]), default=np.inf)
    fine = _fitted(alone, without, rough[order[0]].model, FINE)
    noise = _white(fine.residual, alone)

    def beyond(squares: float) -> float:
        return max(squares - noise, np.sqrt(2.0 * here.size))

    if beyond(fine.left) > LEFT * beyond(before) or beyond(others) < APART * beyond(fine.left):
        return None
    if fine.left > max(SETTLED * before, WHITE * noise):
        return None
    return best[order[0]], _held(fine, len(without.parameters))


class _Alone(NamedTuple):
    """What is left of a wire's force with its effect at its best, the model, and what is uncertain of it."""

    residual: Floats
    model: Model
    stds: Floats

    @property
    def left(self) -> float:
        """Squared error."""
        return _squares(self.residual)


def _left(alone: WiresAlone, model: Model) -> Floats:
    """What a model leaves of the forces, over their noise; far more than any does where it diverges."""
    try:
        return bounded(alone.residual(model))
    except InputError:
        return np.full(alone.size, DIVERGED)


def _best_starts(fitting: Fitting, model: Model) -> list[Start]:
    """Best start of each kind in each wire."""
    alone, spec = fitting.wires_alone, model.spec
    experiment = alone.experiment
    motion = experiment.motion(spec, alone.windows)
    found = candidates(spec, experiment.evidence, motion, fitting.sigma)
    starts = [start for start in found if start.added.block == "wire"]
    squares = fitting.cores.each(lambda start: _squares(_left(alone, start.added_to(model))), starts)
    best: dict[tuple[str, str, str], Start] = {}
    for i in np.argsort(squares).tolist():
        best.setdefault(starts[i].label, starts[i])
    return list(best.values())


def _fitted(alone: WiresAlone, without: Model, model: Model, most: int) -> _Alone:
    """Fit of what `model` has beyond another, by the forces alone; nothing else moves."""
    from scipy.optimize import least_squares

    own = model.parameters[len(without.parameters) :]
    positive, size = np.array([p.positive for p in own]), np.array([p.value for p in own])
    scale = np.where(positive, size, [p.scale for p in own])

    def at(values: Floats) -> Model:
        moved = np.where(positive, size * np.exp(values - 1.0), size + (values - 1.0) * scale)
        return model.at(np.concatenate([without.values, moved]))

    done = least_squares(
        lambda values: _left(alone, at(values)), np.ones(len(own)), diff_step=1e-3, max_nfev=most
    )
    stds = TRUSTED * scale * np.sqrt(np.diag(np.linalg.pinv(done.jac.T @ done.jac)))
    return _Alone(done.fun, at(done.x), stds)


def _held(found: _Alone, since: int) -> Model:
    """Model whose parameters from number `since` on stay where the force of the wire wants them."""
    parameters = list(found.model.parameters)
    for i, std in enumerate(found.stds.tolist(), since):
        value = parameters[i].value
        parameters[i] = replace(parameters[i], prior=(value, max(std, 1e-6 * abs(value))))
    return replace(found.model, parameters=tuple(parameters))


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
