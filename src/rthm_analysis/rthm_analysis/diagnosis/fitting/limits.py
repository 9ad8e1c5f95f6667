"""Detection limits of kinds that no sensitivity measures: sizes at which they would just have been seen."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, cast

import numpy as np
import numpy.typing as npt

from rthm_analysis.diagnosis.criteria.fitting import COINCIDENT_NS, DETECTION_HALVINGS
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.replay.motor import motor_delay
from rthm_analysis.diagnosis.replay.readings import lattice
from rthm_core.effects.registry import changing, ranked
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
    from rthm_analysis.diagnosis.replay.evidence import Evidence
    from rthm_core.compiled import Floats
    from rthm_core.effects import Effect
    from rthm_core.effects.motor import MotorEffect
    from rthm_core.spec import Spec

Limits = dict[tuple[str, str, str], dict[str, float]]
"""By block, kind and place: sizes of parameters."""


def just_seen(power: Callable[[float], float], harmless: float, gross: float, enough: float) -> float | None:
    """Value between two at which an effect has `enough` power, by halving their ratio, and between the last
    two by a power law; None if it never has.

    Parameters
    ----------
    power : callable
        Squared change that the effect makes, in units of the noise; grows from `harmless` to `gross`.
    """
    above, below = power(gross), 0.0
    if not above > enough:
        return None
    for _ in range(DETECTION_HALVINGS):
        middle = float(np.sqrt(harmless * gross))
        found = power(middle)
        if found > enough:
            gross, above = middle, found
        else:
            harmless, below = middle, found
    if not (below > 0.0 and above < np.inf):
        return gross
    share = np.log(enough / below) / np.log(above / below)
    return float(harmless * (gross / harmless) ** share)


def motor_limits(fitting: Fitting, here: Fitted, enough: float) -> Limits:
    """Limits of what can be wrong with the motors, whose positions alone `fitting` sees."""
    model = here.model
    present = {(one.law, one.place) for one in model.added}
    places = [one.place for one in fitting.experiment.evidence.channels]
    apart, left = _apart(fitting.experiment.evidence, model.spec), fitting.residual(model)
    laws = [cast("type[MotorEffect]", law) for law in ranked("motor") if not law.written]
    asked = [(law, place) for law in laws for place in places if (law, place) not in present]

    def limit(one: tuple[type[MotorEffect], str]) -> float | None:
        law, place = one

        def power(value: float) -> float:
            added = EffectInstance("motor", law.kind, place, {_first(law): value, **law.typical})
            try:
                change = fitting.residual(model.plus(added, (), {})) - left
            except InputError:
                return np.inf
            return float(np.sum(np.square(change.reshape(apart.size, -1)[apart])))

        return just_seen(power, law.harmless, law.gross, enough)

    found = zip(asked, fitting.cores.each(limit, asked), strict=True)
    return {("motor", law.kind, place): {_first(law): value} for (law, place), value in found if value}


def _first(law: type[Effect]) -> str:
    """Name of the first parameter of a kind."""
    return next(iter(law.parameters))


def _apart(evidence: Evidence, spec: Spec) -> npt.NDArray[np.bool_]:
    """Samples (s,) that are not at the very step of a command."""
    due = evidence.due_ns + motor_delay(spec)
    at = np.clip(np.searchsorted(due, evidence.stamps_ns), 1, due.size - 1)
    nearest = np.minimum(np.abs(evidence.stamps_ns - due[at - 1]), np.abs(evidence.stamps_ns - due[at]))
    return np.asarray(nearest > COINCIDENT_NS)


def slack_limits(model: Model, forces: dict[str, Floats], noise: dict[str, float], enough: float) -> Limits:
    """Largest pretension that would have been seen to run out, for wires that had one to spare.

    Parameters
    ----------
    model : Model
    forces : dict
        Wire force (s,) by actuator, N.
    noise : dict
        Of its sensor, N.
    """
    law = changing("wire", "pretension")
    slack = {one.place for one in model.spec.effects if one.law.changes == law.changes}
    limits: Limits = {}
    for place, force in forces.items():
        lowest = max(-float(force.min()), 0.0)
        if place in slack or lowest == 0.0:
            continue

        def power(pretension: float, force: Floats = force, place: str = place) -> float:
            return float(np.sum(np.square(np.minimum(force + pretension, 0.0) / noise[place])))

        found = just_seen(power, lowest, 1e-6 * lowest, enough)
        if found:
            limits["wire", law.kind, place] = {_first(law): found}
    return limits


def rounding_limits(fitting: Fitting, matters: float) -> Iterator[tuple[tuple[str, str, str], float]]:
    """Smallest steps of the sensors that would be told, for those that do not round already."""
    evidence = fitting.experiment.evidence
    for channel, noise, column in zip(evidence.channels, fitting.sigma, evidence.measured.T, strict=True):
        if np.isfinite(noise) and lattice(column) is None:
            block = f"sensor.{channel.family}"
            yield (block, changing(block, "step").kind, channel.place), matters * float(noise)
