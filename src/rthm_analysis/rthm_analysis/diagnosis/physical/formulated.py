"""A formula that was earned, as findings: one for each dof and wire, with values, uncertainties and range in
words.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.fitting.fitting import Fitted
from rthm_analysis.diagnosis.missing.binned import binned, spread_over
from rthm_analysis.diagnosis.missing.describe import (
    NAMES,
    domain_of,
    law_of,
    ranges_of,
    symmetry_of,
    takes_energy,
)
from rthm_analysis.diagnosis.missing.motion import Along
from rthm_analysis.diagnosis.missing.residual import residual_force
from rthm_analysis.diagnosis.numbers import bare, percent
from rthm_analysis.diagnosis.physical.acting import acting
from rthm_analysis.diagnosis.physical.locating import when
from rthm_analysis.diagnosis.physical.polygon import is_polygon
from rthm_analysis.diagnosis.physical.values import less_sure, values_of
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.physical.wire_curves import beyond_springs
from rthm_analysis.diagnosis.physical.wire_guesses import OVER
from rthm_analysis.diagnosis.physical.work import law_forces
from rthm_analysis.diagnosis.physical.written import Written
from rthm_analysis.diagnosis.result import Described, Value
from rthm_core.compiled import Floats
from rthm_core.effects.written import Formula, WireFormula

TABLE = "a table, straight between its points and beyond them"


def formulated(judged: Judgement) -> Iterator[Described]:
    """What the formula of a model says of each dof and wire that it acts on."""
    selection = judged.physical.selection
    places: dict[tuple[str, str], list[int]] = {}
    count = len(selection.best.model.added)
    for index in range(count - selection.formulas, count):
        one = selection.best.model.added[index]
        places.setdefault((one.block, one.place), []).append(index)
    for (block, place), indices in places.items():
        yield (_of_dof if block == "plant" else _of_wire)(judged, place, indices)


def _of_wire(judged: Judgement, actuator: str, indices: list[int]) -> Described:
    law, physical = WireFormula, judged.physical
    wire = next(one for one in beyond_springs(physical) if one.name == actuator)
    over, force = wire.of_elongation(wire.force.size)
    at, mean, std, _ = binned(over, force)
    best = judged.physical.selection.best
    terms = [written_of(best, index, misfit=judged.misfit) for index in indices]
    told = None if any(is_polygon(one.text) for one in terms) else sum_of(terms, with_std=False)
    low, high = float(over.min()), float(over.max())
    size = bare(float(np.quantile(np.abs(wire.named), 0.995)), 2)
    formula = f"F = k {OVER} + {sum_of(terms, with_std=True)} in N, with {OVER} = u - x in m"
    law_words = formula.replace("+ -", "- ") if told else TABLE
    words = (
        f"The wire of {actuator} is no linear spring: its force has up to {size} N beside it that depend on "
        f"its elongation: {law_words}, seen from {bare(low)} to {bare(high)} m. {_explains(judged)}"
    )
    return Described(
        law.blocks[0], actuator, law.depends_on, symmetry_of(at, mean), False, False, None, told,
        {OVER: (low, high)}, judged.gone, judged.gone, at, mean, std, words,
        spread_over(over, wire.named[np.isfinite(wire.force)]),
    )  # fmt: skip


def _of_dof(judged: Judgement, dof: str, indices: list[int]) -> Described:
    physical, best = judged.physical, judged.physical.selection.best
    at = physical.along(dof)
    force = law_forces(best.model, indices, at.t, at.x, at.v, at.load)
    among = {name for index in indices for name in best.model.added[index].law.depends_on}
    depends_on = tuple(name for name in at._fields if name in among)
    if _is_mostly_of_load(depends_on, at, force):
        depends_on = ("load", *depends_on[:-1])
    variable = depends_on[0] if depends_on else "x"
    over = at._asdict()[variable]
    where, mean, spread, _ = binned(over, force + _left(judged, dof))
    best = judged.physical.selection.best
    terms = [written_of(best, index, misfit=judged.misfit) for index in indices]
    end = float(physical.evidence.time[-1])
    interval = _until(judged, _all_within([one.interval(end) for one in terms])) or when(judged)
    symmetry = symmetry_of(where, mean) if variable in ("x", "v") else "neither"
    is_table = any(is_polygon(one.text) for one in terms)
    text = None if is_table else sum_of(terms, with_std=False)
    return Described(
        "plant", dof, depends_on, symmetry, takes_energy(force, at), False, interval, text,
        domain_of(at, depends_on), judged.gone, judged.gone, where, mean, spread,
        f"{_words(dof, [] if is_table else terms, depends_on, at, force)} {_explains(judged, interval)}",
        spread_over(over, force),
    )  # fmt: skip


def _all_within(intervals: list[tuple[float, float] | None]) -> tuple[float, float] | None:
    """The interval in which terms act that each have one; None where one has none."""
    known = [one for one in intervals if one is not None]
    if not known or len(known) < len(intervals):
        return None
    return min(begin for begin, _ in known), max(end for _, end in known)


def _is_mostly_of_load(depends_on: tuple[str, ...], at: Along, force: Floats) -> bool:
    """Whether the load tells more of a force than its other variables do: it is then drawn over the load."""
    if "load" not in depends_on:
        return False
    shares = {name: binned(at._asdict()[name], force)[3] for name in depends_on}
    return shares["load"] == max(shares.values())


def _until(judged: Judgement, interval: tuple[float, float] | None) -> tuple[float, float] | None:
    """An interval with the end that shows in the unseen part, where it lies there: no fit has seen it.

    Where the formula leaves nothing there, it goes on.
    """
    physical = judged.physical
    if interval is None or judged.at_noise or interval[1] < physical.evidence.time[physical.train - 1]:
        return interval
    found = acting(physical, physical.evidence.time.size)
    return (interval[0], found.interval[1]) if found and found.interval[1] > interval[0] else interval


def _left(judged: Judgement, dof: str) -> Floats | float:
    """The force (s,) that is missing even with the formula: its noise, where the formula is right."""
    physical, predicted = judged.physical, judged.runs["explained"].predicted
    found = residual_force(physical.evidence, physical.selection.best.model.spec, predicted, dof)
    return 0.0 if found is None else np.nan_to_num(found[2])


def written_of(fitted: Fitted, index: int, text: str = Formula.text, misfit: float = 1.0) -> Written:
    """The formula of an effect that a model adds, with its values, so much less sure."""
    found = less_sure(values_of(fitted, index), misfit)
    return Written(str(found[text]), {k: one for k, one in found.items() if isinstance(one, Value)})


def sum_of(terms: Iterable[Written], *, with_std: bool) -> str:
    """All terms in words."""
    return " + ".join(one.told(with_std=with_std) for one in terms).replace("+ -", "- ")


def _words(dof: str, terms: list[Written], depends_on: tuple[str, ...], at: Along, force: Floats) -> str:
    on = enumerated(NAMES[name].format(dof=dof) for name in depends_on)
    size = bare(float(np.quantile(np.abs(force), 0.995)), 2)
    which = f"that depends on {on}" if on else "whatever it does"
    formula = sum_of(terms, with_std=True)
    law = law_of(formula, depends_on) if terms else TABLE
    seen = f", seen from {ranges}" if (ranges := ranges_of(domain_of(at, depends_on))) else ""
    energy = " It takes energy out." if takes_energy(force, at) else ""
    return f"A force of up to {size} N is missing at {dof} {which}: {law}{seen}.{energy}"


def _explains(judged: Judgement, interval: tuple[float, float] | None = None) -> str:
    """What unseen data say of a formula: little of one that acts in an `interval`, s, before they begin."""
    physical = judged.physical
    if interval is not None and interval[1] < physical.evidence.time[physical.train]:
        return (
            "It is a fitted law that acts before the unseen data begin: they confirm that nothing is missing "
            "behind it, but not what it says."
        )
    share = percent(min(max(judged.gone, 0.0), 1.0))
    return f"It is a fitted law and explains {share} of the mismatch on unseen data."
