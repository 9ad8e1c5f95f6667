"""All mass of a plant, with what its effects let join or leave."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from rthm_core.effects.laws import PlantLaw, has_inertia

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rthm_core.spec.effect import EffectSpec
    from rthm_core.spec.schema import Spec


def heavy(spec: Spec) -> list[EffectSpec]:
    """Effects by which mass joins a dof or leaves it."""
    return [one for one in spec.effects if has_inertia(one.law)]


def steady(spec: Spec) -> list[EffectSpec]:
    """Those of them whose mass is always there, and depends on where the dof is at most."""
    return [one for one in heavy(spec) if cast("type[PlantLaw]", one.law).partition == "none"]


def mass_at(spec: Spec, t: float) -> NDArray[np.float64]:
    """Mass matrix (n, n), in kg, of the plant at rest where it begins, with its effects, from the instant `t`
    (s) on.
    """
    n, start = spec.plant.n, np.array(spec.plant.initial_position)
    mass = np.array(spec.plant.mass, dtype=float).reshape(n, n)
    for one in heavy(spec):
        law, p = cast("type[PlantLaw]", one.law), one.ordered
        mode = sum(limit <= t for limit in law.thresholds(p)) if law.partition == "time" else 0
        apart = np.zeros(n)
        apart[spec.plant.dofs.index(str(one.dof))] = 1.0
        if one.relative_to is not None:
            apart[spec.plant.dofs.index(one.relative_to)] = -1.0
        x = float(apart @ start)
        found = law.inertia(x, 0.0, [*law.initial(x, p)], t, list(p), mode)
        mass += found * np.outer(apart, apart)
    return mass


def instants(spec: Spec) -> list[float]:
    """Instants, s, at which its mass begins or ends to change."""
    laws = [(cast("type[PlantLaw]", one.law), one.ordered) for one in heavy(spec)]
    return sorted({0.0, *(t for law, p in laws if law.partition == "time" for t in law.thresholds(p))})
