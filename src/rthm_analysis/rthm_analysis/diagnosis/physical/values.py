"""Values and standard deviations of what was found, as the result says them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TypeVar

import numpy as np

from rthm_analysis.diagnosis.criteria.search import GAIN_OF_CHANCE, GAIN_PER_PARAMETER
from rthm_analysis.diagnosis.criteria.verdict import SAME_VALUE_SHARE
from rthm_analysis.diagnosis.fitting.fitting import Fitted
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.entries import entry_of, entry_value, nominal_values
from rthm_analysis.diagnosis.replay.model import PROPERTIES, EffectInstance, Parameter, uncertain
from rthm_analysis.diagnosis.result import Retuned, Value
from rthm_core.spec import Spec


def stds_of(fitted: Fitted) -> dict[str, float]:
    """Standard deviation of each parameter of a model."""
    covariance = fitted.sums.covariance()
    return {
        p.key: float(np.sqrt(max(v, 0.0)))
        for p, v in zip(fitted.model.parameters, np.diag(covariance), strict=True)
    }


def values_of(
    fitted: Fitted, index: int, within: Mapping[str, float] = MappingProxyType({})
) -> dict[str, Value | str]:
    """Parameters of an added effect with their standard deviations.

    `within` says of those that no fit but a search found how far they may be off.
    """
    stds, model = stds_of(fitted), fitted.model
    one = model.added[index]
    declared = one.law
    values: dict[str, Value | str] = {}
    for key, value in model.effect_values(index).items():
        if isinstance(value, str):
            values[key] = value
        else:
            std = stds.get(f"{model.name(index)}.{key}", within.get(key, 0.0) / np.sqrt(3.0))
            values[key] = Value(float(value), std, declared.unit(key, one.block))
    return values


Told = TypeVar("Told", Value | str, Retuned)


def less_sure(values: Mapping[str, Told], factor: float) -> dict[str, Told]:
    """The same with standard deviations that are so much larger."""
    return {
        key: value if isinstance(value, str) else replace(value, std=factor * value.std)
        for key, value in values.items()
    }


def settled_by_plant(physical: Physical, name: str, one: EffectInstance) -> dict[str, Value | str]:
    """What the motion of the plant tells of an effect of a motor."""
    best = physical.selection.best
    stds, declared = stds_of(best), one.law
    found = (p for p in best.model.parameters if p.key.startswith(f"{name}."))
    keys = ((p.key.partition(".")[2], p) for p in found)
    return {key: Value(p.value, stds[p.key], declared.unit(key, one.block)) for key, p in keys}


def retuned_values(physical: Physical) -> dict[str, Retuned]:
    """New values of properties that the recording asks for, in the unit of the spec; none that clocks may
    make. Where nothing known drives the plant, they are as uncertain as its mass, at least.
    """
    best = physical.selection.best
    stds, unsure = stds_of(best), {p.key for p in uncertain(physical.spec)}
    found, hardly = {}, _hardly_help(physical, unsure)
    for p in best.model.parameters:
        if p.key in unsure and hardly:
            continue
        if p.key in PROPERTIES or entry_of(p.key) is not None:
            name, found[name] = _of_property(physical.spec, p, stds[p.key])
        elif p.key in unsure:
            found[p.key] = _of_effect(physical.spec, p, stds[p.key])
    if not physical.evidence.is_forced:
        mass = physical.spec.uncertainty.plant.mass
        found = {k: replace(one, std=float(np.hypot(one.std, one.value * mass))) for k, one in found.items()}
    return {
        name: one
        for name, one in found.items()
        if abs(one.value - one.nominal) > SAME_VALUE_SHARE * abs(one.nominal)
    }


def _hardly_help(physical: Physical, unsure: set[str]) -> bool:
    """Whether other values of what the spec calls uncertain do not explain more than chance would."""
    moved = sum(p.key in unsure for p in physical.selection.best.model.parameters)
    gain = physical.nominal.squares - physical.selection.base.squares
    return gain < (GAIN_OF_CHANCE + GAIN_PER_PARAMETER * (moved - 1)) * physical.fitting.reduced_chi2


def _of_property(spec: Spec, parameter: Parameter, std: float) -> tuple[str, Retuned]:
    """Name and new value of a property of the spec, or of an entry; that of a single one has no index."""
    key = parameter.key
    if key in PROPERTIES:
        (nominal,) = nominal_values(spec, key)
        return key, Retuned(nominal, nominal * parameter.value, abs(nominal) * std, PROPERTIES[key])
    whole, _ = entry_of(key) or (key, 0)
    name = whole if len(nominal_values(spec, whole)) == 1 else key
    return name, Retuned(entry_value(spec, key), parameter.value, std, PROPERTIES.get(whole, ""))


def _of_effect(spec: Spec, parameter: Parameter, std: float) -> Retuned:
    """New value of a parameter of an effect that the spec has."""
    name, _, key = parameter.key.partition(".")
    one = next(one for one in spec.effects if one.name == name)
    return Retuned(one.numbers[key], parameter.value, std, one.law.unit(key, one.block))
