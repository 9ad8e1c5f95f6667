"""Whether names were earned: what unseen data say of a model, and which of its effects may be told."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.search import SEARCH_MOST_EFFECTS
from rthm_analysis.diagnosis.criteria.verdict import (
    ARITHMETIC_SHARE_OF_SLOW_POWER,
    ASTRAY_ERROR_RATIO,
    CURVE_SHARE_OF_REST,
    IMITATOR_EXPLAINED_SHARE,
    LEFT_SHARE_OF_SLOW_POWER,
    MAJOR_EXPLAINED_SHARE,
    MEMORY_EXPLAINED_SHARE,
    MEMORY_LEFT_RATIO,
    MISMATCH_SHARE_OF_ERROR,
    MOST_LEFT_SLOW_POWER,
    NO_BETTER_THAN_STILL,
    NOISE_FLOOR_RATIO,
    SMOOTH_LAW_EXPLAINED_SHARE,
    TRAINING_SLOW_POWER,
    WORSE_ERROR_RATIO,
)
from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.fitting.fitting import Fitted
from rthm_analysis.diagnosis.missing.curves import CurveFit, Regression, free_curves
from rthm_analysis.diagnosis.missing.describe import is_clear
from rthm_analysis.diagnosis.numbers import bare, percent
from rthm_analysis.diagnosis.physical.above_noise import Laws, found, least_gone
from rthm_analysis.diagnosis.physical.contradicted import denied
from rthm_analysis.diagnosis.physical.driven import is_driven_wrong
from rthm_analysis.diagnosis.physical.judged import (
    Simulated,
    held_out_squares,
    nrmse,
    remainders,
    simulate_all,
    spread,
)
from rthm_analysis.diagnosis.physical.remainder import Remainder
from rthm_analysis.diagnosis.physical.rounding import is_rounding
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.physical.unrelated import possible_causes, unrelated
from rthm_analysis.diagnosis.replay.entries import entry_of
from rthm_analysis.diagnosis.replay.model import Model, uncertain
from rthm_analysis.diagnosis.result import Refused
from rthm_analysis.diagnosis.search.replacing import is_identified, is_seen


class Missing(NamedTuple):
    """What a model leaves of the recording, and the free curves of it, best first."""

    regression: Regression
    curves: list[CurveFit]


@dataclass(frozen=True)
class Judgement:
    """What the recording as a whole says of the nominal, the retuned and the explaining model.

    Attributes
    ----------
    physical : Physical
    runs : dict
        Simulated: ``nominal``, ``retuned``, ``explained``.
    composed : bool
        Whether its last effects are a formula that was compared with free curves, and so earned.
    """

    physical: Physical
    runs: dict[str, Simulated]
    composed: bool = False

    def of(self, physical: Physical, *, composed: bool = False) -> Judgement:
        """The same recording with another model that explains it, judged."""
        best = simulate_all(physical, physical.selection.best)
        return Judgement(physical, self.runs | {"explained": best}, composed)

    @cached_property
    def left(self) -> dict[str, tuple[Remainder, ...]]:
        """By model and channel: what is left."""
        return {name: remainders(self.physical, run.predicted) for name, run in self.runs.items()}

    @property
    def left_over(self) -> tuple[Remainder, ...]:
        """By channel: what is left of the model that is told, without effects that were not earned."""
        return self.left[self.told]

    @cached_property
    def misfit(self) -> float:
        """Error of the model that is told on unseen data, over the noise, where that is largest; at least 1.

        Its values are so much less sure than noise alone would leave them.
        """
        return _misfit(self.left_over)

    @property
    def told(self) -> str:
        """Name of the model that is told: with effects only where they were earned."""
        return "explained" if self.earned else "retuned"

    @property
    def told_fit(self) -> Fitted:
        """The fit of that model."""
        return self.physical.selection.best if self.earned else self.physical.selection.base

    @property
    def told_missing(self) -> Missing:
        """What is left of it."""
        return self.missing if self.earned else self.missing_without

    @cached_property
    def squares(self) -> dict[str, float]:
        """By model: squared error on unseen data, in units of the noise."""
        return {name: held_out_squares(self.physical, run.predicted) for name, run in self.runs.items()}

    @cached_property
    def expected(self) -> float:
        """Squared error on unseen data that noise alone would leave."""
        physical = self.physical
        return float(np.isfinite(physical.evidence.measured[physical.train :]).sum())

    @property
    def names(self) -> bool:
        """Whether effects were added."""
        return bool(self.physical.selection.rounds)

    @property
    def tuned(self) -> bool:
        """Whether values were changed."""
        return self.physical.selection.base.model.parameters != self.physical.nominal.model.parameters

    @cached_property
    def at_noise(self) -> bool:
        """Whether the best model is at the noise over the whole recording, unseen part included.

        A model without anything fitted owes all of it; one with fitted values is as good as they are sure.
        Some channels may deny what is left of others, but never all of each other.
        """
        quiet = self._quiet_channels
        return all(quiet) or (any(quiet) and all(self._channel_at_noise(k) for k in range(len(quiet))))

    @cached_property
    def _quiet_channels(self) -> list[bool]:
        """By channel: whether the best model leaves nothing of it but noise."""
        return [self._is_quiet(k) for k in range(len(self.left["explained"]))]

    @property
    def settled(self) -> bool:
        """Whether nothing is left of the model that is told."""
        return self.at_noise and self.earned == self.names

    def _channel_at_noise(self, channel: int) -> bool:
        return (
            self._quiet_channels[channel]
            or self._is_noise_of_sensor(channel)
            or is_rounding(self.physical, self.runs["explained"].predicted, channel)
        )

    def _is_quiet(self, channel: int) -> bool:
        one = self.left["explained"][channel]
        low = bool(np.isfinite(one.rms)) and one.rms <= NOISE_FLOOR_RATIO * one.loudness
        if self.names or self.tuned:
            quiet = one.train < TRAINING_SLOW_POWER or (self.names and self._mostly_gone(channel))
        else:
            quiet = not (one.in_train or one.in_held_out or one.parts.size)
        return low and quiet

    @cached_property
    def wrong_sensors(self) -> set[str]:
        """Blocks of sensors that are off while another channel denies every motion or force that would do it;
        none where anything else is off as well, or all are: they cannot deny each other.
        """
        predicted, channels = self.runs["explained"].predicted, self.physical.evidence.channels
        off = [k for k in range(len(channels)) if not self._channel_at_noise(k)]
        if len(off) == len(channels) > 1 or not np.isfinite(predicted).all():
            return set()
        if not all(denied(self.physical, predicted, k) for k in off):
            return set()
        return {f"sensor.{channels[k].family}" for k in off}

    def _is_noise_of_sensor(self, channel: int) -> bool:
        """Whether another channel denies that an error is motion or force, and nothing foretells it."""
        physical, predicted = self.physical, self.runs["explained"].predicted
        if not np.isfinite(predicted).all() or not denied(physical, predicted, channel):
            return False
        measured = physical.evidence.measured
        error = measured[:, channel] - predicted[:, channel]
        others = np.nan_to_num(np.delete(measured, channel, axis=1)).T
        return unrelated(error, [*possible_causes(physical.evidence, predicted), *others])

    @property
    def _is_vague(self) -> bool:
        """Whether one of the effects has values that the recording does not tell."""
        selection = self.physical.selection
        return not all(is_identified(selection.best, index) for index in range(len(selection.rounds)))

    @property
    def _are_seen(self) -> bool:
        """Whether of each effect the recording tells at least one value, as it would be told."""
        return not self.unseen

    @cached_property
    def unseen(self) -> list[int]:
        """Effects of which no value is told from zero, as unsure as what is left makes them."""
        selection, misfit = self.physical.selection, _misfit(self.left["explained"])
        return [i for i in range(len(selection.rounds)) if not is_seen(selection.best, i, misfit)]

    @property
    def _changes(self) -> int:
        """How many effects, and values that the spec calls exact, the model changes."""
        selection, unsure = self.physical.selection, {p.key for p in uncertain(self.physical.spec)}
        entries = ((p.key, found[0]) for p in selection.base.model.parameters if (found := entry_of(p.key)))
        return len(selection.rounds) + sum(unsure.isdisjoint(names) for names in entries)

    @property
    def is_worse(self) -> bool:
        """Whether a signal is further from unseen data with the names than without, or than where nothing
        moves, whatever the noise.
        """
        physical = self.physical
        for channel, level in enumerate(physical.noise.level):
            before, after = (
                nrmse(physical, self.runs[name].predicted, channel) for name in ("retuned", "explained")
            )
            if after > max(
                min(WORSE_ERROR_RATIO * before, NO_BETTER_THAN_STILL),
                NOISE_FLOOR_RATIO * level / spread(physical, channel),
            ):
                return True
        return False

    @property
    def is_astray(self) -> bool:
        """Whether the model that is told moves much more than was recorded."""
        predicted = self.runs[self.told].predicted
        channels = range(predicted.shape[1])
        return max(nrmse(self.physical, predicted, k) for k in channels) > ASTRAY_ERROR_RATIO

    def _mostly_gone(self, channel: int) -> bool:
        """Whether what is left of a channel in the training part is little of what was."""
        before, after = self.left["nominal"][channel], self.left["explained"][channel]
        return after.train - 1.0 < min(LEFT_SHARE_OF_SLOW_POWER * (before.train - 1.0), MOST_LEFT_SLOW_POWER)

    @cached_property
    def shares(self) -> list[float]:
        """Part of the retuned model's squared error on unseen data that each effect removes, in order."""
        selection, found = self.physical.selection, []
        before = whole = max(self.squares["retuned"], 1e-300)
        for i, tried in enumerate(selection.rounds):
            last = i + 1 == len(selection.rounds)
            after_fit = selection.best if last else tried[0].fitted
            after = (
                self.squares["explained"]
                if last
                else held_out_squares(self.physical, simulate_all(self.physical, after_fit).predicted)
            )
            found.append((before - after) / whole)
            before = min(before, after)
        return found

    @cached_property
    def gone(self) -> float:
        """Part of the retuned model's mismatch above the noise that the best model removes on unseen data."""
        before, after = self.squares["retuned"] - self.expected, self.squares["explained"] - self.expected
        return 1.0 - max(after, 0.0) / max(before, 1e-300)

    @property
    def curves(self) -> list[CurveFit]:
        """Free curves of what the best of the named models leaves, or of what is left without names."""
        return self.missing.curves

    @cached_property
    def missing(self) -> Missing:
        """What the best of the named models leaves."""
        return self._missing(self.physical.selection.best.model)

    @cached_property
    def missing_without(self) -> Missing:
        """What is left without any name."""
        return self._missing(self.physical.selection.base.model) if self.names else self.missing

    def _missing(self, model: Model) -> Missing:
        physical = self.physical
        physical.fitting.progress("asking on what the missing force depends")
        left = Regression(physical.experiment, physical.windows, physical.noise, model, physical.train)
        return Missing(left, free_curves(left))

    @cached_property
    def earned(self) -> bool:
        """Whether the effects that were added may be named.

        Never a curve put together from pieces, several sensors that are wrong at once, what makes a signal
        worse, kinds of which no value is told, more changes of the model than are looked for, or anything but
        the plant's where the motors are not understood.
        """
        selection = self.physical.selection
        if selection.formulas:
            return self.composed or (self.at_noise and not self.is_worse)
        if not self.names or selection.in_pieces or selection.blames_several or self.is_worse:
            return False
        if self._changes > SEARCH_MOST_EFFECTS or not self._are_seen:
            return False
        if self.is_driven_wrong and not (self.at_noise and selection.in_plant):
            return False
        return self._is_enough_at_noise if self.at_noise else self._is_enough_above_noise

    @property
    def _is_enough_at_noise(self) -> bool:
        """Whether effects remove what there is of a mismatch, and leave no curve that they should have been.

        Several, and what can imitate others, have certain values, but for one that remembers what nothing
        else does; several that can imitate others, or are terms of one curve, leave nothing.
        """
        selection = self.physical.selection
        if self.mismatch > MISMATCH_SHARE_OF_ERROR and (
            self.gone < MAJOR_EXPLAINED_SHARE or self._leaves_a_curve
        ):
            return False
        if len(selection.rounds) == 1:
            return not (selection.imitates and self._is_vague) or self._remembers
        return not (self._is_vague or self._leaves_some)

    @property
    def _yardsticks(self) -> list[CurveFit]:
        """The free curves by which kinds are judged."""
        return [one.yardstick for one in self.curves if one.feature.judges]

    @property
    def _leaves_a_curve(self) -> bool:
        """Whether a free curve finds most of what they leave, where that is more than next to nothing."""
        return self.gone < SMOOTH_LAW_EXPLAINED_SHARE and any(
            is_clear(one) and found(one) > CURVE_SHARE_OF_REST for one in self._yardsticks
        )

    @property
    def _is_enough_above_noise(self) -> bool:
        """Whether plain kinds are the law that is missing; of kinds that can imitate others, whether next to
        nothing is left.

        What can imitate others, or stands alone, has certain values.
        """
        selection = self.physical.selection
        if self._is_vague and (selection.imitates or len(selection.rounds) == 1):
            return False
        if selection.imitates:
            helps = min(self.shares) > 0.0  # what makes unseen data worse was only made up for by the next
            enough = self.gone > IMITATOR_EXPLAINED_SHARE or self._remembers
            return enough and selection.of_the_rig and helps
        if self.gone <= least_gone(selection.best.model):
            return False
        yardsticks = [one for one in self._yardsticks if not one.feature.straight]
        return Laws(selection.best.model, self.gone, yardsticks).are_told

    @property
    def _remembers(self) -> bool:
        """Whether one effect leaves a small part of what any force without memory would."""
        if len(self.physical.selection.rounds) > 1 or self.gone < MEMORY_EXPLAINED_SHARE:
            return False
        curves = [min(one.share, one.held_out_share) for one in self.missing_without.curves]
        return 1.0 - self.gone < MEMORY_LEFT_RATIO * (1.0 - max(curves, default=0.0))

    @cached_property
    def is_driven_wrong(self) -> bool:
        """Whether the motors do what no kind explains, so that nobody knows what the wires were given."""
        return is_driven_wrong(self.physical)

    @property
    def mismatch(self) -> float:
        """Part of the retuned model's squared error on unseen data that is not noise."""
        return 1.0 - self.expected / max(self.squares["retuned"], 1e-300)

    @property
    def _leaves_some(self) -> bool:
        """Whether effects that can imitate others, or are terms of one curve, still leave something."""
        selection = self.physical.selection
        return (selection.imitates or selection.in_terms) and any(
            (after.in_train or after.in_held_out)
            and after.slow - 1.0 > ARITHMETIC_SHARE_OF_SLOW_POWER * (before.slow - 1.0)
            for before, after in zip(self.left["retuned"], self.left["explained"], strict=True)
        )

    @cached_property
    def refused(self) -> tuple[Refused, ...]:
        """What was found in the training part and is not told, and why."""
        if not self.names or self.earned:
            return ()
        worst = max(one.rms / one.loudness for one in self.left["explained"])
        labels = [tried[0].label for tried in self.physical.selection.rounds]
        names = enumerated(kind.replace("_", " ") for _, kind, _ in labels)
        gone = percent(max(self.gone, 0.0))
        words = (
            f"{names.capitalize()}: fitted to the first two thirds, it removed {gone} of the mismatch in the "
            f"last, which left {bare(worst)} times the noise: not enough for a name."
        )
        return tuple(Refused(block, kind, words) for block, kind, _ in labels)


def _misfit(left: Iterable[Remainder]) -> float:
    """Largest error on unseen data, over the noise, of what is left of the channels; at least 1."""
    return max((1.0, *(one.rms / one.loudness for one in left)))
