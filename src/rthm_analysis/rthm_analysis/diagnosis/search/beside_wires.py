"""What goes beside an effect that the own force of a wire tells.

Where several effects are large, no simulation comes near the recording before all are there. That of a wire
is known whatever the others are, so they are looked for beside it.
"""

from __future__ import annotations

from dataclasses import replace

from rthm_analysis.diagnosis.fitting.fitting import WRONG, Fitted, Fitting
from rthm_analysis.diagnosis.search.combining import combined
from rthm_analysis.diagnosis.search.judging import FLEXIBLE, Choice, Tried, doubt, in_order
from rthm_analysis.diagnosis.search.pairing import PAIRED, companions, let_go
from rthm_analysis.diagnosis.search.refining import finished, fit_further, unfitted
from rthm_analysis.diagnosis.search.told_wires import told_wires

BESIDE = 2
"""Plain kinds that may stand beside what the force of a wire told."""

TOGETHER = 8
"""Steps of a fit of two effects that were found apart."""


def led_by_a_wire(fitting: Fitting, base: Fitted) -> Choice | None:
    """What the own force of a wire tells, with what goes best beside it.

    Its values stay where that force wants them until the model is near the recording: alone it may be further
    away than without.

    Returns
    -------
    Choice or None
        None where no force tells, the model is near without, one effect of another kind alone comes near the
        noise, or nothing that was found beside it is better than nothing.
    """
    found = told_wires(fitting, base) if fitting.doubt > WRONG else []
    told = [fit_further(fitting, unfitted(start, base, model), None, 1) for start, model in found]
    chains = sorted((_with_plain(fitting, base, one) for one in told), key=_error)
    if chains and len(chains[0]) == 1 and _near(fitting, chains[0][-1]):
        return _begun_with(fitting, base, chains[0])
    singles = [one for one in companions(fitting, base) if one.label[0] != "wire"] if told else []
    chains += [] if chains and _near(fitting, chains[0][-1]) else _with_any(fitting, told, base, singles)
    best = min(chains, key=_error, default=None)
    alone = [one.error for one in singles[:1] if _near(fitting, one)]
    if best is None or best[-1].error > min([float(base.left_out.sum()), *alone]):
        return None
    return _begun_with(fitting, base, best)


def _error(chain: list[Tried]) -> float:
    """Error of a model with all effects of a chain."""
    return chain[-1].error


def _near(fitting: Fitting, tried: Tried) -> bool:
    """Whether a model is so near the recording that what it has may be trusted."""
    return doubt(fitting, tried.fitted) < WRONG


def _with_plain(fitting: Fitting, base: Fitted, told: Tried) -> list[Tried]:
    """An effect that the force of a wire told, with the plain kinds that come near the noise beside it.

    They are looked for together, then one after the other.
    """
    if _near(fitting, told):
        return [told]
    fitting.progress(f"looking for plain kinds that go with {told.label[1]}")
    before = fitting.doubt
    with fitting.simple_only(), fitting.told_by(*told.label[1:]), fitting.based_on(told.fitted.model):
        together = combined(fitting, Choice(base, told.fitted, [[told]])).rounds
        found = [tried[0] for tried in together]
        if not _near(fitting, found[-1]):
            fitting.doubt = before
            found = min(found, one_by_one(fitting, told), key=_error)
    fitting.doubt = before
    return found


def one_by_one(fitting: Fitting, told: Tried) -> list[Tried]:
    """What the force of a wire told, with one kind after the other until they come near the noise."""
    found = [told]
    while len(found) <= BESIDE and not _near(fitting, found[-1]):
        fitting.rebase(found[-1].fitted.model)
        beside = companions(fitting, found[-1].fitted)
        if not beside or beside[0].error > found[-1].error:
            break
        found.append(beside[0])
    return found


def _with_any(fitting: Fitting, told: list[Tried], base: Fitted, singles: list[Tried]) -> list[list[Tried]]:
    """The effects that the force of a wire told, each with what goes best beside it, of whatever kind."""
    pairs = []
    for one in told:
        fitting.progress(f"looking for what goes with {one.label[1]}")
        beside = [_beside(fitting, base, one, single) for single in singles[:PAIRED]]
        if not any(_near(fitting, other) for other in beside):
            with fitting.told_by(*one.label[1:]), fitting.based_on(one.fitted.model):
                beside += companions(fitting, one.fitted)
        pairs += [[one, other] for other in _telling(fitting, in_order(beside))]
    return pairs


def _telling(fitting: Fitting, tried: list[Tried]) -> list[Tried]:
    """The best of some candidates, best first; of the plain ones where none comes near the noise."""
    plain = [one for one in tried if one.label[1] not in FLEXIBLE]
    near = bool(tried) and _near(fitting, tried[0])
    return (tried if near or not plain else plain)[:1]


def _beside(fitting: Fitting, base: Fitted, told: Tried, single: Tried) -> Tried:
    """An effect that was found alone, fitted beside what the force of a wire told."""
    values, alone = told.fitted.model.values, single.fitted.model
    own = len(base.model.parameters)
    values[:own] = alone.values[:own]
    added = replace(single.start.added, parameters=alone.effect_values(len(alone.added) - 1))
    start = replace(single.start, added=added)
    model = start.added_to(told.fitted.model.at(values))
    with fitting.based_on(model):
        return fit_further(fitting, unfitted(start, told.fitted, model), None, TOGETHER)


def _begun_with(fitting: Fitting, base: Fitted, found: list[Tried]) -> Choice:
    """Choice that begins with these effects, fitted to their end where they are near the recording."""
    last = found[-1]
    fitting.told |= {one.label[2]: one.label[1] for one in found if one.label[0] == "wire"}
    fitting.doubt = doubt(fitting, last.fitted)
    fitting.rebase(last.fitted.model)
    if fitting.doubt < WRONG:
        last = finished(fitting, let_go(last, base))
    return Choice(base, last.fitted, [[one] for one in (*found[:-1], last)])
