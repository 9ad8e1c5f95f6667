"""Where a force may be missing: on a dof, or between two of them."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import PAIRS_OF_FEW_DOFS
from rthm_core.physical.laws import Place
from rthm_core.spec.effect import between, place_keys

if TYPE_CHECKING:
    from rthm_core.spec import Spec


class Site(NamedTuple):
    """A place on the plant, and its name in a spec."""

    name: str
    place: Place

    @property
    def is_pair(self) -> bool:
        """Whether it is between two dofs."""
        return self.place.other >= 0


def site_of(spec: Spec, name: str) -> Site:
    """The site of a name.

    Examples
    --------
    >>> from rthm_core.spec import shipped_spec
    >>> site_of(shipped_spec("paper"), "x1").place.dof
    0
    """
    assert spec.plant is not None
    dof, other = place_keys(name)
    at = [spec.plant.dofs.index(one) for one in (dof, other) if one is not None]
    return Site(name, Place(*at))


def sites(spec: Spec) -> list[Site]:
    """All dofs, then pairs of them: every one of a few dofs, else those that a spring or damper couples."""
    assert spec.plant is not None
    dofs, n = spec.plant.dofs, len(spec.plant.dofs)
    coupled = np.reshape(np.abs(spec.plant.stiffness) + np.abs(spec.plant.damping), (n, n)) > 0.0
    pairs = [
        between(dofs[i], dofs[j])
        for i, j in combinations(range(n), 2)
        if n <= PAIRS_OF_FEW_DOFS or coupled[i, j]
    ]
    return [site_of(spec, name) for name in (*dofs, *pairs)]
