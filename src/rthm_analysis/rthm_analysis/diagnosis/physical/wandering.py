"""The one position of a plant under known forces that all other signals contradict, as its zero wanders."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations

import numpy as np

from rthm_analysis.diagnosis.criteria.readings import WANDER_ROUNDS, WANDER_SHARE
from rthm_analysis.diagnosis.faults.stretches import with_column
from rthm_analysis.diagnosis.faults.wander import Wander, slow_part
from rthm_analysis.diagnosis.fitting.noise import noise_levels
from rthm_analysis.diagnosis.physical.beginning import Baseline, begin
from rthm_analysis.diagnosis.physical.leaves_noise import at_noise
from rthm_analysis.diagnosis.physical.remainder import remainder_of
from rthm_analysis.diagnosis.physical.shown_elsewhere import forces_on, is_denied, moved_elsewhere
from rthm_analysis.diagnosis.replay.budget import budget_for
from rthm_analysis.diagnosis.replay.evidence import MOTION, Channel, Evidence
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.windows import windows
from rthm_core.compiled import Floats
from rthm_core.spec import Spec
from rthm_core.substructure import substructure


def wandering(evidence: Evidence, spec: Spec, progress: Callable[[str], None]) -> Wander | None:
    """The sensor of a position whose zero wanders, where the other signals, without it, leave nothing but
    noise, and would show any force on a dof that moved this one so; None where there is none, or several.

    Parameters
    ----------
    evidence : Evidence
    spec : Spec
        The nominal model; what it calls uncertain is fitted to the other signals.
    progress : callable
        Told what is being done, in words.
    """
    asked = _asked(evidence)
    if not asked or not _is_off(evidence, spec, asked):
        return None
    progress("comparing each position with what the other signals make of it")
    found = [one for channel in asked if (one := _found(evidence, spec, channel, progress)) is not None]
    return found[0] if len(found) == 1 else None


def _asked(evidence: Evidence) -> list[Channel]:
    """Positions that no rate of the same dof checks, beside signals of other dofs."""
    if evidence.driven_by != "force" or len(evidence.recordings) > 1 or not np.any(evidence.load):
        return []
    rates = {one.place for one in evidence.channels if one.family != "position"}
    alone = [one for one in evidence.channels if one.family == "position" and one.place not in rates]
    return alone if len({one.place for one in evidence.channels}) > 1 else []


def _is_off(evidence: Evidence, spec: Spec, asked: list[Channel]) -> bool:
    """Whether the spec as it stands leaves more than noise of any of these."""
    runs = windows(evidence, spec, known_start=False)
    if not runs.is_one:
        return False
    experiment = Experiment(evidence, np.empty(0))
    experiment.begin_at(evidence.stamps_ns[runs.start])
    left = evidence.measured - experiment.predicted(spec, runs)
    if not np.isfinite(left).any():
        return False
    columns = [evidence.channels.index(one) for one in asked]
    noise = noise_levels(left, evidence.measured)
    return any(_is_more_than_noise(left[:, k] / noise[k], evidence.trained) for k in columns)


def _is_more_than_noise(errors: Floats, train: int) -> bool:
    """Whether errors over the noise are more, in a part of the recording or in all of it."""
    one = remainder_of(errors, train)
    return one.in_train or one.in_held_out


def _found(
    evidence: Evidence, spec: Spec, channel: Channel, progress: Callable[[str], None]
) -> Wander | None:
    """How the zero of a position wanders, beside a model of all others; None where it does not."""
    column = evidence.channels.index(channel)
    left = _left_beside(evidence, spec, column, progress)
    if left is None:
        return None
    train, noise = evidence.trained, noise_levels(left, evidence.measured)
    others = np.delete(left / noise, column, axis=1)
    if any(_is_more_than_noise(one, train) for one in others.T):
        return None
    error = slow_part(evidence.time, left[:, column], evidence.period)
    rest = left[:, column] - error
    if not _is_slow(left[:, column], rest, float(noise[column]), train):
        return None
    plausible = _undenied(evidence, spec, column, error, left, noise)
    if plausible is None:
        return None
    return Wander(channel, error, not _is_more_than_noise(rest / noise[column], train), plausible)


def _left_beside(
    evidence: Evidence, spec: Spec, column: int, progress: Callable[[str], None]
) -> Floats | None:
    """Errors (s, k) of all channels beside a model that is fitted to all but one; None where the others
    leave more than noise.

    What the spec calls uncertain may go with the size of the motion that is left out: it is then fitted to
    the fast part of that as well.
    """
    begun = _begun(evidence.without([column]), spec, progress)
    if not begun.runs.is_one or not at_noise(begun.fitting, begun.retuned):
        return None
    left = _left_by(evidence, begun)
    for _ in range(WANDER_ROUNDS if begun.retuned.model.parameters else 0):
        if left is None:
            break
        error = slow_part(evidence.time, left[:, column], evidence.period)
        steady = with_column(evidence, column, evidence.measured[:, column] - error)
        left = _left_by(evidence, _begun(steady, spec, progress))
    return left


def _begun(evidence: Evidence, spec: Spec, progress: Callable[[str], None]) -> Baseline:
    """The retuned model of a recording."""
    return begin(evidence, Model(spec), np.empty(0), budget_for(evidence.stamps_ns.size), progress)[0]


def _left_by(evidence: Evidence, begun: Baseline) -> Floats | None:
    """Errors (s, k) of all channels of a recording beside a retuned model of some; None where it diverges."""
    fitting, fitted = begun.fitting, begun.retuned
    experiment = Experiment(evidence, np.empty(0), between=fitting.experiment.between)
    experiment.begin_at(evidence.stamps_ns[begun.runs.start])
    predicted = experiment.predicted(fitted.model.spec, fitting.corrected(begun.runs, fitted))
    return evidence.measured - predicted if np.isfinite(predicted).all() else None


def _is_slow(left: Floats, rest: Floats, noise: float, train: int) -> bool:
    """Whether an error is more than noise, and its slow part is most of it."""
    if not _is_more_than_noise(left / noise, train):
        return False
    whole, without = (float(np.nanmean(np.square(one))) for one in (left, rest))
    return without - noise**2 < (1.0 - WANDER_SHARE) * (whole - noise**2)


def _undenied(
    evidence: Evidence, spec: Spec, column: int, error: Floats, left: Floats, noise: Floats
) -> tuple[str, ...] | None:
    """Places between dofs at which a force may have made an error, for all that the others show; None where
    a force on a dof may.
    """
    assert spec.plant is not None
    names, plant = spec.plant.dofs, substructure(spec.plant)
    step = float(np.median(np.diff(evidence.time)))
    here = names.index(evidence.channels[column].place)
    others = [k for k in range(len(evidence.channels)) if k != column]

    def denied(force: Floats) -> bool:
        for k in others:
            one = evidence.channels[k]
            dofs, rates = (here, names.index(one.place)), MOTION.index(one.family)
            shown = moved_elsewhere(plant, force, error, step, dofs, rates)
            if is_denied(shown, np.nan_to_num(left[:, k]), float(noise[k])):
                return True
        return False

    alone, between = forces_on(len(names))
    if not all(denied(one) for one in alone):
        return None
    pairs = (f"between {one} and {other}" for one, other in combinations(names, 2))
    return tuple(pair for pair, force in zip(pairs, between, strict=True) if not denied(force))
