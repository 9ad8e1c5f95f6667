"""Effects beside one that was identified in a wire from its measured force.

Where several effects are large, no simulation comes near the recording before all are there. That of a wire
is known whatever the others are, so they are looked for beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import POOR_FIT_CHI2
from rthm_analysis.diagnosis.criteria.search import BESIDE_WIRE_MOST_EFFECTS, BESIDE_WIRE_STEPS, PAIRED_KINDS
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.search.combining import combined
from rthm_analysis.diagnosis.search.driven_plant import driven_plant, short_runs
from rthm_analysis.diagnosis.search.judging import (
    FittedCandidate,
    Selection,
    in_order,
    reduced_chi2,
)
from rthm_analysis.diagnosis.search.pairing import companions, let_go
from rthm_analysis.diagnosis.search.refining import finished, fit_further, unfitted
from rthm_analysis.diagnosis.search.replacing import rounds_refitted
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_analysis.diagnosis.search.wire_from_force import released, wires_from_force
from rthm_core.errors import InputError

Choose = Callable[[Fitting, Fitted], Selection]
"""Explanation of what a model leaves by effects."""


def selected_from_wire(fitting: Fitting, base: Fitted, choose: Choose) -> Selection | None:
    """The effect that was identified in a wire, with what goes best beside it.

    Its values stay where that force wants them until the model is near the recording: alone it may be further
    away than without.

    Returns
    -------
    Selection or None
        None where none was identified, the model is near without, one effect of another kind alone comes near
        the noise, or nothing that was found beside it is better than nothing.
    """
    found = wires_from_force(fitting, base) if fitting.reduced_chi2 > POOR_FIT_CHI2 else []
    identified = [fit_further(fitting, unfitted(start, base, model), None, 1) for start, model in found]
    chains = [[one] for one in identified]
    chains += _with_what_the_plant_lacks(fitting, base, choose, _far(fitting, chains))
    chains += _with_one(fitting, _far(fitting, chains, most=1))
    plain = [_with_plain(fitting, base, one) for one in _far(fitting, chains, most=1)]
    singles = _singles(fitting, base) if _far(fitting, [*chains, *plain]) else []
    chains += [*plain, *_with_a_single(fitting, base, identified, singles)]
    chains += [_one_after_another(fitting, base, one) for one in plain if _far(fitting, chains)]
    best = min(chains, key=_error, default=None)
    alone = [one.error for one in singles[:1] if _near(fitting, one)]
    if best is None or best[-1].error > min([float(base.left_out.sum()), *alone]):
        return None
    return _begun_with(fitting, base, best)


def _far(
    fitting: Fitting, chains: list[list[FittedCandidate]], most: int | None = None
) -> list[list[FittedCandidate]]:
    """The same chains of at most so many effects, where none comes near the noise and more may be done."""
    if fitting.budget.spent or any(_near(fitting, chain[-1]) for chain in chains):
        return []
    return [chain for chain in chains if most is None or len(chain) <= most]


def _error(chain: list[FittedCandidate]) -> float:
    """Error of a model with all effects of a chain."""
    return chain[-1].error


def _near(fitting: Fitting, tried: FittedCandidate) -> bool:
    """Whether a model is so near the recording that what it has may be trusted."""
    return reduced_chi2(fitting, tried.fitted) < POOR_FIT_CHI2


def _with_plain(fitting: Fitting, base: Fitted, chain: list[FittedCandidate]) -> list[FittedCandidate]:
    """The effect of a wire, with the plain kinds that do better beside it, looked for together."""
    wire, before = chain[0], fitting.reduced_chi2
    fitting.progress(f"looking for plain kinds that go with {wire.label[1]}")
    with _beside_nothing_else(fitting, wire):
        begun = Selection(base, chain[-1].fitted, [[one] for one in chain])
        found = [tried[0] for tried in combined(fitting, begun, turns=1).rounds]
    fitting.reduced_chi2 = before
    return found


def _one_after_another(fitting: Fitting, base: Fitted, chain: list[FittedCandidate]) -> list[FittedCandidate]:
    """The same with a better combination in place of the plain kinds, or with one after the other, as far as
    the budget goes.
    """
    found, before = _with_plain(fitting, base, chain), fitting.reduced_chi2
    if not _near(fitting, found[-1]):
        with _beside_nothing_else(fitting, chain[0]):
            found = min(found, one_by_one(fitting, chain[0]), key=_error)
    fitting.reduced_chi2 = before
    return found


@contextmanager
def _beside_nothing_else(fitting: Fitting, wire: FittedCandidate) -> Iterator[None]:
    """Look for plain kinds, and for no other in a wire whose kind is known, for a while."""
    with (
        fitting.simple_only(),
        fitting.identified_as(*wire.label[1:]),
        fitting.based_on(wire.fitted.model),
    ):
        yield


def one_by_one(fitting: Fitting, wire: FittedCandidate) -> list[FittedCandidate]:
    """The effect of a wire, with one kind after the other until they come near the noise."""
    found = [wire]
    while (
        len(found) <= BESIDE_WIRE_MOST_EFFECTS and not _near(fitting, found[-1]) and not fitting.budget.spent
    ):
        fitting.rebase(found[-1].fitted.model)
        beside = companions(fitting, found[-1].fitted)
        if not beside or beside[0].error > found[-1].error:
            break
        found.append(beside[0])
    return found


def _with_what_the_plant_lacks(
    fitting: Fitting, base: Fitted, choose: Choose, chains: list[list[FittedCandidate]]
) -> list[list[FittedCandidate]]:
    """Effects of a wire, each with what the plant alone lacks under the force that was measured."""
    driven = driven_plant(fitting, base) if chains else None
    if driven is None:
        return []
    fitting.progress("looking at the plant under the force that was measured")
    alone = driven.fit(driven.base)
    driven.reduced_chi2 = reduced_chi2(driven, alone)
    found = choose(driven, alone)
    best = found.best.model
    starts = [tried[0].start.having(best.effect_values(i)) for i, tried in enumerate(found.rounds)]
    return [_with_all(fitting, base, chain, starts) for chain in chains]


def _with_all(
    fitting: Fitting, base: Fitted, chain: list[FittedCandidate], starts: list[InitialGuess]
) -> list[FittedCandidate]:
    """A chain with further effects, if any, fitted together: in short runs first, where contacts are soon in
    step.
    """
    model = chain[-1].fitted.model
    for start in starts:
        model = start.added_to(model)
    with suppress(InputError, np.linalg.LinAlgError):
        free = released(model, len(base.model.parameters))
        model = short_runs(fitting, free).fit(free).model
    with fitting.based_on(model):
        begun = unfitted(chain[-1].start, chain[-1].fitted, model)
        last = fit_further(fitting, begun, None, BESIDE_WIRE_STEPS)
    added = [*(one.start for one in chain), *starts]
    return [*chain[:-1], *(replace(last, start=start) for start in added[len(chain) - 1 :])]


def _with_one(fitting: Fitting, chains: list[list[FittedCandidate]]) -> list[list[FittedCandidate]]:
    """Effects of a wire, each with the one effect, of whatever kind, that goes best beside it."""
    found = []
    for chain in chains:
        if fitting.budget.spent:
            break
        fitting.progress(f"looking for what goes with {chain[0].label[1]}")
        with fitting.identified_as(*chain[0].label[1:]), fitting.based_on(chain[0].fitted.model):
            beside = companions(fitting, chain[0].fitted)
        found += [[*chain, other] for other in _most_telling(fitting, in_order(beside))]
    return found


def _singles(fitting: Fitting, base: Fitted) -> list[FittedCandidate]:
    """Effects beside the wires that explain something alone, best first."""
    return [one for one in companions(fitting, base) if one.label[0] != "wire"]


def _with_a_single(
    fitting: Fitting, base: Fitted, identified: list[FittedCandidate], singles: list[FittedCandidate]
) -> list[list[FittedCandidate]]:
    """Effects of a wire, each with the best of those that explain something alone."""
    pairs = []
    for one in identified if singles else []:
        beside = [_beside(fitting, base, one, single) for single in singles[:PAIRED_KINDS]]
        pairs += [[one, other] for other in _most_telling(fitting, in_order(beside))]
    return pairs


def _most_telling(fitting: Fitting, tried: list[FittedCandidate]) -> list[FittedCandidate]:
    """The best of some candidates, best first; of the plain ones where none comes near the noise."""
    plain = [one for one in tried if not one.law.flexible]
    near = bool(tried) and _near(fitting, tried[0])
    return (tried if near or not plain else plain)[:1]


def _beside(
    fitting: Fitting, base: Fitted, wire: FittedCandidate, single: FittedCandidate
) -> FittedCandidate:
    """An effect that was found alone, fitted beside that of a wire."""
    values, alone = wire.fitted.model.values, single.fitted.model
    own = len(base.model.parameters)
    values[:own] = alone.values[:own]
    start = single.start.having(alone.effect_values(len(alone.added) - 1))
    model = start.added_to(wire.fitted.model.at(values))
    with fitting.based_on(model):
        return fit_further(fitting, unfitted(start, wire.fitted, model), None, BESIDE_WIRE_STEPS)


def _begun_with(fitting: Fitting, base: Fitted, found: list[FittedCandidate]) -> Selection:
    """Selection that begins with these effects, fitted to their end where they are near the recording."""
    last = found[-1]
    fitting.identified |= {one.label[2]: one.label[1] for one in found if one.label[0] == "wire"}
    fitting.reduced_chi2 = reduced_chi2(fitting, last.fitted)
    fitting.rebase(last.fitted.model)
    if fitting.reduced_chi2 < POOR_FIT_CHI2:
        last = finished(fitting, let_go(last, base))
    rounds = [[one] for one in (*found[:-1], last)]
    return rounds_refitted(fitting, Selection(base, last.fitted, rounds))
