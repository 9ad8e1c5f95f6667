"""Hypotheses that explain a recording as well as what was named."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rthm_analysis.diagnosis.experiment.advice import SOFTWARE
from rthm_analysis.diagnosis.experiment.contrasts import MOVED, having
from rthm_analysis.diagnosis.experiment.planning import Hypothesis
from rthm_analysis.diagnosis.search.judging import distinguishable
from rthm_core.effects.blocks import family
from rthm_core.spec.effect import placed

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.physical.side import Physical
    from rthm_core.spec import EffectSpec, Spec


def rivals_of(physical: Physical, patched: Spec) -> list[Hypothesis]:
    """Models of plant and wire that this recording does not tell from the best one, likeliest first.

    Parameters
    ----------
    physical : Physical
    patched : Spec
        The best one, with what was found in the software of the loop, which the rivals share.
    """
    best = physical.selection.best
    found: dict[str, tuple[str, Spec]] = {}
    for tried in physical.selection.rounds:
        for other in tried:
            block, kind, _ = other.label
            if block in MOVED and other.fitted is not best and not distinguishable(best, other.fitted):
                found.setdefault(kind, (other.law.called(), other.fitted.model.spec))
    named = {e.kind for e in patched.effects}
    return [
        Hypothesis(name, _with_software(spec, patched))
        for kind, (name, spec) in found.items()
        if kind not in named
    ]


def _with_software(spec: Spec, patched: Spec) -> Spec:
    there = {(e.block, e.kind) for e in spec.effects}
    shared = (e for e in patched.effects if family(e.block) in SOFTWARE and (e.block, e.kind) not in there)
    sections = [_section(one) for one in shared]
    return having(spec, *sections) if sections else spec


def _section(one: EffectSpec) -> dict[str, object]:
    return {"block": one.block, "kind": one.kind, **placed(one.block, one.place), **one.parameters}
