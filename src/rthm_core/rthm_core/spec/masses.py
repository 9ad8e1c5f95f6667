"""All mass of a plant, with what its effects let join or leave."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from rthm_core.effects.laws import PlantLaw, has_coupling, has_inertia

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from rthm_core.spec.effect import EffectSpec
    from rthm_core.spec.schema import Spec


def heavy(spec: Spec) -> list[EffectSpec]:
    """Effects by which mass joins a dof or leaves it, or couples two."""
    return [one for one in spec.effects if has_inertia(one.law) or has_coupling(one.law)]


def steady(spec: Spec) -> list[EffectSpec]:
    """Those of them whose mass is always there, and depends on where the dofs are at most."""
    return [one for one in heavy(spec) if cast("type[PlantLaw]", one.law).partition == "none"]


def mass_at(spec: Spec, t: float, some: Iterable[EffectSpec] | None = None) -> NDArray[np.float64]:
    """Mass matrix (n, n), in kg, of the plant at rest where it begins, with its effects or `some` of them,
    from the instant `t` (s) on.
    """
    n = spec.plant.n
    mass = np.array(spec.plant.mass, dtype=float).reshape(n, n)
    for one in heavy(spec) if some is None else some:
        mass += _share(spec, one, t)
    return mass


def _share(spec: Spec, one: EffectSpec, t: float) -> NDArray[np.float64]:
    """What an effect adds to the mass matrix (n, n); no number where its law has none there."""
    try:
        return _added(spec, one, t)
    except (ArithmeticError, ValueError):
        return np.full((spec.plant.n, spec.plant.n), np.nan)


def _added(spec: Spec, one: EffectSpec, t: float) -> NDArray[np.float64]:
    """What an effect adds to the mass matrix (n, n).

    Raises
    ------
    ArithmeticError, ValueError
        Where its law has no number.
    """
    n, dofs, start = spec.plant.n, spec.plant.dofs, np.array(spec.plant.initial_position)
    law, p, share = cast("type[PlantLaw]", one.law), one.ordered, np.zeros((n, n))
    reach = np.eye(n)[dofs.index(str(one.dof))]
    other = np.zeros(n) if one.relative_to is None else np.eye(n)[dofs.index(one.relative_to)]
    if has_coupling(law):
        mass = law.coupling(float(reach @ start), float(other @ start), list(p))
        share += mass * (np.outer(reach, other) + np.outer(other, reach))
    if has_inertia(law):
        apart = reach - other
        x = float(apart @ start)
        mode = sum(limit <= t for limit in law.thresholds(p)) if law.partition == "time" else 0
        mass = law.inertia(x, 0.0, [*law.initial(x, p)], t, list(p), mode)
        share += mass * np.outer(apart, apart)
    return share


def instants(spec: Spec) -> list[float]:
    """Instants, s, at which its mass begins or ends to change."""
    laws = [(cast("type[PlantLaw]", one.law), one.ordered) for one in heavy(spec)]
    return sorted({0.0, *(t for law, p in laws if law.partition == "time" for t in law.thresholds(p))})
