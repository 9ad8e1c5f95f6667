"""Which plain kinds are the law that is missing, where something else is left above the noise as well.

The yardstick of a law is a free curve over the variables on which it depends: what such a curve still finds
in what the law leaves, the law should have been. A curve over other variables is of something else.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from rthm_analysis.diagnosis.criteria.verdict import (
    CURVE_SHARE_OF_REST,
    FRICTION_EXPLAINED_SHARE,
    FRICTION_EXPLAINED_SHARE_BESIDE_LOAD,
    FRICTION_JUMP_SHARE,
    FRICTION_JUMP_STDS,
    NEEDED_RATIO_TO_REST,
    NEEDED_SHARE_OF_MISMATCH,
    SMOOTH_LAW_EXPLAINED_SHARE,
    STEPS_WITHOUT_EFFECT,
)
from rthm_analysis.diagnosis.fitting.fitting import Fitted
from rthm_analysis.diagnosis.missing.curves import CurveFit
from rthm_analysis.diagnosis.missing.describe import is_confirmed
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.search.judging import Selection
from rthm_analysis.diagnosis.search.replacing import is_identified, model_of
from rthm_core.spec.effect import place_keys


def needed_only(physical: Physical) -> tuple[Physical, tuple[tuple[str, str, str], ...]]:
    """The same without effects that the training part hardly misses, and their labels."""
    selection, needless = physical.selection, []
    while len(selection.rounds) > 1:
        index, without = _least_needed(physical, selection)
        if without is None:
            break
        needless.append(selection.rounds[index][0].label)
        selection = _left_out(selection, index, without)
    return replace(physical, selection=selection), tuple(needless)


def certain_only(physical: Physical) -> tuple[Physical, tuple[tuple[str, str, str], ...]]:
    """The same without effects whose values are not told beside the others, and their labels."""
    selection, vague = physical.selection, []
    while len(selection.rounds) > 1:
        index = next((i for i in range(len(selection.rounds)) if not is_identified(selection.best, i)), None)
        without = None if index is None else _without(physical, selection, index)
        if index is None or without is None:
            break
        vague.append(selection.rounds[index][0].label)
        selection = _left_out(selection, index, without)
    return replace(physical, selection=selection), tuple(vague)


def without_each(physical: Physical, indices: Sequence[int]) -> Physical:
    """The same without some of its effects, the others fitted again; one whose lack diverges stays."""
    selection = physical.selection
    for index in sorted(indices, reverse=True):
        without = _without(physical, selection, index)
        if without is not None:
            selection = _left_out(selection, index, without)
    if not selection.rounds:
        selection = replace(selection, best=selection.base)
    return replace(physical, selection=selection)


def _least_needed(physical: Physical, selection: Selection) -> tuple[int, Fitted | None]:
    """Effect that is needed least, and the model without it; None where it is needed."""
    found = [_without(physical, selection, index) for index in range(len(selection.rounds))]
    errors = [np.inf if one is None else float(one.left_out.sum()) for one in found]
    index = int(np.argmin(errors))
    best = float(selection.best.left_out.sum())
    mismatch = float(selection.base.left_out.sum()) - physical.fitting.expected
    least = min(
        NEEDED_SHARE_OF_MISMATCH * mismatch, NEEDED_RATIO_TO_REST * (best - physical.fitting.expected)
    )
    return index, found[index] if errors[index] - best < least else None


def _left_out(selection: Selection, index: int, without: Fitted) -> Selection:
    """The selection without one of its effects, given the best model without it."""
    rounds = [tried for i, tried in enumerate(selection.rounds) if i != index]
    return replace(selection, best=without, rounds=rounds)


def _without(physical: Physical, selection: Selection, index: int) -> Fitted | None:
    """Best model without one of its effects; None where it diverges."""
    others = [(i, tried[0].start) for i, tried in enumerate(selection.rounds) if i != index]
    try:
        return physical.fitting.fit(model_of(selection, others), most=STEPS_WITHOUT_EFFECT)
    except np.linalg.LinAlgError:
        return None


def least_gone(model: Model) -> float:
    """Part of the mismatch that plain kinds must remove to be the law, whatever free curves say."""
    laws = [one.law for one in model.added]
    if any(not law.jump and law.depends_on for law in laws) or not any(law.jump for law in laws):
        return SMOOTH_LAW_EXPLAINED_SHARE
    beside_load = any(not law.depends_on for law in laws)
    return FRICTION_EXPLAINED_SHARE_BESIDE_LOAD if beside_load else FRICTION_EXPLAINED_SHARE


@dataclass(frozen=True)
class Laws:
    """Plain kinds that were found, and what says whether they are the missing law.

    Parameters
    ----------
    model : Model
    gone : float
        Part of the retuned model's mismatch that all together remove on unseen data.
    curves : list of CurveFit
        What all together leave, as free curves.
    """

    model: Model
    gone: float
    curves: list[CurveFit]

    @property
    def are_told(self) -> bool:
        """Whether each is the whole law of its variables, or a jump that no smooth force has.

        A constant force depends on nothing; beside others it is the offset of their law.
        """
        added = self.model.added
        rubs = [one for one in added if one.law.jump and self._jumps(one)]
        constant = [one for one in added if not one.law.depends_on]
        smooth = [one for one in added if one not in rubs and one not in constant]
        if smooth or not rubs:
            return self.gone > SMOOTH_LAW_EXPLAINED_SHARE and all(
                self._is_whole(one) for one in smooth or constant
            )
        return self.gone > (FRICTION_EXPLAINED_SHARE_BESIDE_LOAD if constant else FRICTION_EXPLAINED_SHARE)

    def _jumps(self, friction: EffectInstance) -> bool:
        """Whether a free curve over the velocity, beside the friction, leaves its jump at rest as it is, and
        none shows that it is not there all the time, or is as large.
        """
        force = float(self.model.effect_values(self.model.added.index(friction))[friction.law.jump])
        there = self._there(friction)
        changing = [c for c in there if c.feature.depends_on == ("v", "t")]
        if any(
            found(c) > CURVE_SHARE_OF_REST or (is_confirmed(c) and c.largest > FRICTION_JUMP_SHARE * force)
            for c in changing
        ):
            return False
        for curve in there:
            if curve.feature.depends_on == ("v",):
                change, std = float(curve.sizes[-1]), float(curve.stds[-1])
                return abs(change) < FRICTION_JUMP_SHARE * force and force - change > FRICTION_JUMP_STDS * std
        return False

    def _is_whole(self, one: EffectInstance) -> bool:
        """Whether curves over any of its variables, or all where it has none, find little in what is left.

        Friction without its jump may be any of the forces against the motion; so it is only by itself, and
        without a curve beside it.
        """
        of_it = set(one.law.depends_on)
        shared = [c for c in self._there(one) if not of_it or of_it.intersection(c.feature.depends_on)]
        if one.law.jump and (len(self.model.added) > 1 or any(map(is_confirmed, shared))):
            return False
        return max(map(found, shared), default=0.0) < CURVE_SHARE_OF_REST

    def _there(self, one: EffectInstance) -> list[CurveFit]:
        """Curves at the place of a law and at its dofs, or all for one of a wire."""
        there = (one.place, *place_keys(one.place))
        return [curve for curve in self.curves if one.block != "plant" or curve.site in there]


def found(curve: CurveFit) -> float:
    """Part of what is left that a curve explains both where it was fitted and on unseen data."""
    return min(curve.share, curve.held_out_share)
