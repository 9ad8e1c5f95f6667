"""Effects beside one that was identified in a wire from its measured force.

Where several effects are large, no simulation comes near the recording before all are there. That of a wire
is known whatever the others are, so they are looked for beside it.
"""

from __future__ import annotations

from dataclasses import replace

from rthm_analysis.diagnosis.criteria.fitting import POOR_FIT_CHI2
from rthm_analysis.diagnosis.criteria.search import BESIDE_WIRE_MOST_EFFECTS, BESIDE_WIRE_STEPS, PAIRED_KINDS
from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.search.combining import combined
from rthm_analysis.diagnosis.search.judging import (
    FittedCandidate,
    Selection,
    in_order,
    reduced_chi2,
)
from rthm_analysis.diagnosis.search.pairing import companions, let_go
from rthm_analysis.diagnosis.search.refining import finished, fit_further, unfitted
from rthm_analysis.diagnosis.search.wire_from_force import wires_from_force


def selected_from_wire(fitting: Fitting, base: Fitted) -> Selection | None:
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
    chains = sorted((_with_plain(fitting, base, one) for one in identified), key=_error)
    if chains and len(chains[0]) == 1 and _near(fitting, chains[0][-1]):
        return _begun_with(fitting, base, chains[0])
    asks = identified and not fitting.budget.spent
    singles = [one for one in companions(fitting, base) if one.label[0] != "wire"] if asks else []
    chains += (
        [] if chains and _near(fitting, chains[0][-1]) else _with_any(fitting, identified, base, singles)
    )
    best = min(chains, key=_error, default=None)
    alone = [one.error for one in singles[:1] if _near(fitting, one)]
    if best is None or best[-1].error > min([float(base.left_out.sum()), *alone]):
        return None
    return _begun_with(fitting, base, best)


def _error(chain: list[FittedCandidate]) -> float:
    """Error of a model with all effects of a chain."""
    return chain[-1].error


def _near(fitting: Fitting, tried: FittedCandidate) -> bool:
    """Whether a model is so near the recording that what it has may be trusted."""
    return reduced_chi2(fitting, tried.fitted) < POOR_FIT_CHI2


def _with_plain(fitting: Fitting, base: Fitted, wire: FittedCandidate) -> list[FittedCandidate]:
    """The effect of a wire, with the plain kinds that come near the noise beside it.

    They are looked for together, then one after the other, as far as the budget goes.
    """
    if _near(fitting, wire) or fitting.budget.spent:
        return [wire]
    fitting.progress(f"looking for plain kinds that go with {wire.label[1]}")
    before = fitting.reduced_chi2
    with (
        fitting.simple_only(),
        fitting.identified_as(*wire.label[1:]),
        fitting.based_on(wire.fitted.model),
    ):
        together = combined(fitting, Selection(base, wire.fitted, [[wire]])).rounds
        found = [tried[0] for tried in together]
        if not _near(fitting, found[-1]):
            fitting.reduced_chi2 = before
            found = min(found, one_by_one(fitting, wire), key=_error)
    fitting.reduced_chi2 = before
    return found


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


def _with_any(
    fitting: Fitting, identified: list[FittedCandidate], base: Fitted, singles: list[FittedCandidate]
) -> list[list[FittedCandidate]]:
    """Effects of a wire, each with what goes best beside it, of whatever kind."""
    pairs = []
    for one in identified:
        if fitting.budget.spent:
            break
        fitting.progress(f"looking for what goes with {one.label[1]}")
        beside = [_beside(fitting, base, one, single) for single in singles[:PAIRED_KINDS]]
        if not any(_near(fitting, other) for other in beside):
            with fitting.identified_as(*one.label[1:]), fitting.based_on(one.fitted.model):
                beside += companions(fitting, one.fitted)
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
    added = replace(single.start.added, parameters=alone.effect_values(len(alone.added) - 1))
    start = replace(single.start, added=added)
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
    return Selection(base, last.fitted, [[one] for one in (*found[:-1], last)])
