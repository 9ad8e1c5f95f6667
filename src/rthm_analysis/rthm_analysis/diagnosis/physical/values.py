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
from rthm_analysis.diagnosis.replay.entries import entry_of, entry_value
from rthm_analysis.diagnosis.replay.model import PROPERTIES, EffectInstance, Parameter, nominal_values
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
    found = _scaled_values(physical) | _entry_values(physical)
    if not physical.evidence.is_forced:
        mass = physical.spec.uncertainty.plant.mass
        found = {k: replace(one, std=float(np.hypot(one.std, one.value * mass))) for k, one in found.items()}
    return {
        name: one
        for name, one in found.items()
        if abs(one.value - one.nominal) > SAME_VALUE_SHARE * abs(one.nominal)
    }


def _scaled_values(physical: Physical) -> dict[str, Retuned]:
    """Values of what the spec calls uncertain, matrices with one factor; none where these hardly help."""
    best, found = physical.selection.best, {}
    stds = stds_of(best)
    unsure = {f"{one.name}.{key}" for one in physical.spec.effects for key in one.uncertainty}
    scaled = [p for p in best.model.parameters if p.key in PROPERTIES or p.key in unsure]
    gain = physical.nominal.squares - physical.selection.base.squares
    if gain < (GAIN_OF_CHANCE + GAIN_PER_PARAMETER * (len(scaled) - 1)) * physical.fitting.reduced_chi2:
        return {}
    for p in scaled:
        if p.key in unsure:
            found[p.key] = _of_effect(physical.spec, p, stds[p.key])
            continue
        values = nominal_values(physical.spec, p.key)
        for i, nominal in enumerate(values):
            if nominal:
                name = p.key if len(values) == 1 else f"{p.key}[{i}]"
                std = abs(nominal) * stds[p.key]
                found[name] = Retuned(nominal, nominal * p.value, std, PROPERTIES[p.key])
    return found


def _of_effect(spec: Spec, parameter: Parameter, std: float) -> Retuned:
    """New value of a parameter of an effect that the spec has."""
    name, _, key = parameter.key.partition(".")
    one = next(one for one in spec.effects if one.name == name)
    return Retuned(one.numbers[key], parameter.value, std, one.law.unit(key, one.block))


def _entry_values(physical: Physical) -> dict[str, Retuned]:
    """Values of single entries, whatever the spec says of them."""
    best, found = physical.selection.best, {}
    stds = stds_of(best)
    for p in best.model.parameters:
        entry = entry_of(p.key)
        if entry is not None:
            name = entry[0] if _is_single(physical, entry[0]) else p.key
            unit = PROPERTIES.get(entry[0], "")
            found[name] = Retuned(entry_value(physical.spec, p.key), p.value, stds[p.key], unit)
    return found


def _is_single(physical: Physical, key: str) -> bool:
    return len(nominal_values(physical.spec, key)) == 1
