"""Pairs of hypotheses that a finding leaves open, where the search itself has left no rival."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

from rthm_analysis.diagnosis.experiment.planning import Hypothesis
from rthm_analysis.diagnosis.result import Limit, Physics, Retuned
from rthm_core.effects import effect
from rthm_core.spec import apply
from rthm_core.spec.effect import placed

if TYPE_CHECKING:
    from rthm_core.spec import Spec

MOVED = ("plant", "wire")
"""Blocks of which other motions of the rig say more."""


class Contrast(NamedTuple):
    """Two hypotheses, and what the difference between them is about."""

    about: str
    pair: tuple[Hypothesis, Hypothesis]


def without_weakest(patched: Spec, physics: Sequence[Physics]) -> Contrast | None:
    """The patched spec with and without the effect that explains least; None without one in plant or wire."""
    named = [one for one in physics if one.block in MOVED]
    if not named:
        return None
    weakest = min(named, key=lambda one: one.share if math.isfinite(one.share) else math.inf)
    label = weakest.block, weakest.kind, weakest.place or weakest.block
    kept = [e.name for e in patched.effects if (e.block, e.kind, e.place) != label]
    without = apply(patched, {"effects": kept or None})
    name = effect(weakest.kind, weakest.block).called()
    return Contrast(name, (Hypothesis(f"with {name}", patched), Hypothesis("without", without)))


def least_known(patched: Spec, retuned: Mapping[str, Retuned]) -> Contrast | None:
    """The patched spec, and with the least known parameter one standard deviation larger."""
    sizes = {name: one.std / abs(one.value) for name, one in retuned.items() if one.value and one.std > 0.0}
    if not sizes:
        return None
    name = max(sizes, key=lambda one: sizes[one])
    more = apply(patched, {name: retuned[name].value + retuned[name].std})
    return Contrast(name, (Hypothesis("as found", patched), Hypothesis("larger", more)))


def smallest_seen(nominal: Spec, limits: Mapping[str, Limit]) -> list[tuple[Contrast, Limit]]:
    """For each common effect with a detection limit: the nominal spec without and with it at that limit.

    Whether there is a little of it is what a test without findings leaves open.
    """
    found: dict[str, tuple[Contrast, Limit]] = {}
    for key, limit in limits.items():
        block, *middle, kind, parameter = key.split(".")
        if block != "plant" or kind in found or not 0.0 < limit.value < math.inf:
            continue
        law = effect(kind, block)
        if not law.common:
            continue
        assert nominal.plant is not None
        place = placed(block, middle[0] if middle else nominal.plant.dofs[0])
        more = having(nominal, {"block": block, "kind": kind, **place, parameter: limit.value})
        pair = Hypothesis("nothing", nominal), Hypothesis(law.called(), more)
        found[kind] = Contrast(law.called(), pair), limit
    return list(found.values())


def having(spec: Spec, *sections: dict[str, object]) -> Spec:
    """The spec with further effects."""
    taken = {e.name for e in spec.effects}
    free = (name for i in range(1, len(taken) + len(sections) + 1) if (name := f"more{i}") not in taken)
    new = dict(zip(free, sections, strict=False))
    return apply(spec, {"effects": [*(e.name for e in spec.effects), *new], **new})
