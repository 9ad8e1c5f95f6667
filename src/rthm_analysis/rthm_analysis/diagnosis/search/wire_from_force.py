"""Wires identified from their measured force, whatever the plant does beside them.

Where two effects are both large, no simulation comes near the recording before both are there. But the force
of a wire follows from the recorded motion of its ends alone.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import DIVERGED_ERROR
from rthm_analysis.diagnosis.criteria.search import (
    WIRE_FINE_RUNS,
    WIRE_LEFT_SHARE,
    WIRE_MOST_ALIKE,
    WIRE_NOISE_TO_WHITE,
    WIRE_RIVAL_ERROR_RATIO,
    WIRE_ROUGH_RUNS,
    WIRE_SETTLED_SHARE,
    WIRE_STD_FACTOR,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting, bounded
from rthm_analysis.diagnosis.fitting.wires_alone import WiresAlone
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.search.candidates import candidates
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.compiled import Floats
from rthm_core.errors import InputError

Explained = list[tuple[InitialGuess, Model]]
"""Effects that each explain the force of a wire, and models with them."""

_ANSWERS: WeakKeyDictionary[WiresAlone, tuple[Model, Explained]] = WeakKeyDictionary()
"""The last answer of each check: a search asks what its beginning has asked before."""


def wires_from_force(fitting: Fitting, fitted: Fitted) -> Explained:
    """Effects that each explain the force of a wire, and models with them, best first.

    None where no effect does, or so many that the force tells nothing, or where an offset of its sensor does.
    """
    model, found = _ANSWERS.get(fitting.wires_alone, (None, []))
    if model is not fitted.model:
        found = _from_force(fitting, fitted.model)
        _ANSWERS[fitting.wires_alone] = fitted.model, found
    return found


def _from_force(fitting: Fitting, without: Model) -> Explained:
    alone = fitting.wires_alone
    if not alone.forces:
        return []
    nothing = _alone(alone, without, alone.residual(without), np.empty(0))
    if _without_offsets(alone, nothing) < WIRE_NOISE_TO_WHITE * nothing.white:
        return []
    found = _best_fits(fitting, nothing)
    least = min((one.beyond(nothing) for _, one in found), default=np.inf)
    little = max(WIRE_SETTLED_SHARE * nothing.left, (WIRE_NOISE_TO_WHITE - 1.0) * nothing.white)
    if least > min(WIRE_LEFT_SHARE * nothing.beyond(nothing), little):
        return []
    alike = [(start, one) for start, one in found if one.beyond(nothing) < WIRE_RIVAL_ERROR_RATIO * least]
    return [
        (start, _held(one, len(without.parameters))) for start, one in alike if len(alike) <= WIRE_MOST_ALIKE
    ]


class _Alone(NamedTuple):
    """What is left of a wire's force with its effect at its best, the model, and what is uncertain of it.

    Its squared error is `left`; white noise with the same differences from sample to sample has `white`.
    """

    residual: Floats
    model: Model
    stds: Floats
    left: float
    white: float

    def beyond(self, nothing: _Alone) -> float:
        """Squared error that is no noise, at least what chance leaves.

        An effect that makes the noise of the recorded motion larger excuses no more than a little of it.
        """
        noise = min(self.white, WIRE_NOISE_TO_WHITE * nothing.white)
        return float(max(self.left - noise, np.sqrt(2.0 * self.residual.size)))


def _alone(alone: WiresAlone, model: Model, residual: Floats, stds: Floats) -> _Alone:
    columns = residual.reshape(-1, len(alone.forces))
    white = 0.5 * float(np.square(np.diff(columns, axis=0)).sum())
    return _Alone(residual, model, stds, _squares(residual), white)


def _without_offsets(alone: WiresAlone, nothing: _Alone) -> float:
    """Squared error that the best offset of each force leaves."""
    columns = nothing.residual.reshape(-1, len(alone.forces))
    return _squares((columns - columns.mean(axis=0)).ravel())


def _best_fits(fitting: Fitting, nothing: _Alone) -> list[tuple[InitialGuess, _Alone]]:
    """The kinds that explain the force best, best first: fitted to their end as far as the budget goes, but
    for those that explain little where another leaves as good as nothing.
    """
    alone, without = fitting.wires_alone, nothing.model
    starts = _best_starts(fitting, without)
    rough = fitting.cores.each(
        lambda start: _fitted(alone, without, start.added_to(without), WIRE_ROUGH_RUNS), starts
    )
    order = sorted(range(len(starts)), key=lambda i: rough[i].beyond(nothing))[: WIRE_MOST_ALIKE + 1]
    fine: list[_Alone] = []
    for i in order:
        settled = any(one.beyond(nothing) < WIRE_SETTLED_SHARE * nothing.left for one in fine)
        behind = settled and rough[i].beyond(nothing) > WIRE_LEFT_SHARE * nothing.beyond(nothing)
        ends = behind or fitting.budget.spent
        fine.append(rough[i] if ends else _fitted(alone, without, rough[i].model, WIRE_FINE_RUNS))
    found = zip([starts[i] for i in order], fine, strict=True)
    return sorted(found, key=lambda one: one[1].beyond(nothing))


def _left(alone: WiresAlone, model: Model) -> Floats:
    """What a model leaves of the forces, over their noise; far more than any does where it diverges."""
    try:
        return bounded(alone.residual(model))
    except InputError:
        return np.full(alone.size, DIVERGED_ERROR)


def _best_starts(fitting: Fitting, model: Model) -> list[InitialGuess]:
    """Best start of each kind in each wire."""
    alone, spec = fitting.wires_alone, model.spec
    experiment = alone.experiment
    motion = experiment.motion(spec, alone.windows)
    found = candidates(spec, experiment.evidence, motion, fitting.sigma)
    starts = [start for start in found if start.added.block == "wire"]
    squares = fitting.cores.each(lambda start: _squares(_left(alone, start.added_to(model))), starts)
    best: dict[tuple[str, str, str], InitialGuess] = {}
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

    def left(values: Floats) -> Floats:
        return _left(alone, at(values))

    done = least_squares(left, np.ones(len(own)), diff_step=1e-3, max_nfev=most)  # type: ignore[arg-type]
    jac = np.asarray(done.jac)
    stds = WIRE_STD_FACTOR * scale * np.sqrt(np.diag(np.linalg.pinv(jac.T @ jac)))
    return _alone(alone, at(done.x), done.fun, stds)


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
