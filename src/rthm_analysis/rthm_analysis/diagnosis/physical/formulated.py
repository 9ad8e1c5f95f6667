"""A formula that was earned, as findings: one for each dof, with values, uncertainties and range in words."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.missing.binned import binned, spread_over
from rthm_analysis.diagnosis.missing.describe import (
    NAMES,
    domain_of,
    law_of,
    ranges_of,
    symmetry_of,
    takes_energy,
)
from rthm_analysis.diagnosis.missing.motion import Along, along
from rthm_analysis.diagnosis.missing.residual import residual_force
from rthm_analysis.diagnosis.numbers import bare, percent
from rthm_analysis.diagnosis.physical.locating import when
from rthm_analysis.diagnosis.physical.polygon import is_polygon
from rthm_analysis.diagnosis.physical.values import less_sure, values_of
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.physical.work import law_forces
from rthm_analysis.diagnosis.physical.written import Written
from rthm_analysis.diagnosis.result import Described, Value
from rthm_core.compiled import Floats

TABLE = "a table, straight between its points and beyond them"


def formulated(judged: Judgement) -> Iterator[Described]:
    """What the formula of a model says of each dof that it acts on."""
    selection = judged.physical.selection
    places: dict[str, list[int]] = {}
    count = len(selection.best.model.added)
    for index in range(count - selection.formulas, count):
        places.setdefault(selection.best.model.added[index].place, []).append(index)
    for dof, indices in places.items():
        yield _of_dof(judged, dof, indices)


def _of_dof(judged: Judgement, dof: str, indices: list[int]) -> Described:
    physical, best = judged.physical, judged.physical.selection.best
    assert best.model.spec.plant is not None
    motion = physical.experiment.motion(best.model.spec, physical.windows)
    at = along(physical.evidence, motion, best.model.spec.plant.dofs.index(dof), dof)
    force = law_forces(best.model, indices, at.t, at.x, at.v, at.load)
    among = {name for index in indices for name in best.model.added[index].law.depends_on}
    depends_on = tuple(name for name in at._fields if name in among)
    variable = depends_on[0] if depends_on else "x"
    over = at._asdict()[variable]
    where, mean, spread, _ = binned(over, force + _left(judged, dof))
    terms = [_written(judged, index) for index in indices]
    end = float(physical.evidence.time[-1])
    interval = (terms[0].interval(end) if len(terms) == 1 else None) or when(judged)
    symmetry = symmetry_of(where, mean) if variable in ("x", "v") else "neither"
    is_table = any(is_polygon(one.text) for one in terms)
    text = None if is_table else _sum(one.told(with_std=False) for one in terms)
    return Described(
        "plant", dof, None, depends_on, symmetry, takes_energy(force, at), False, interval, text,
        domain_of(at, depends_on), judged.gone, judged.gone, where, mean, spread,
        _words(judged, dof, [] if is_table else terms, depends_on, at, force), spread_over(over, force),
    )  # fmt: skip


def _left(judged: Judgement, dof: str) -> Floats | float:
    """The force (s,) that is missing even with the formula: its noise, where the formula is right."""
    physical, predicted = judged.physical, judged.runs["explained"].predicted
    found = residual_force(physical.evidence, physical.selection.best.model.spec, predicted, dof)
    return 0.0 if found is None else np.nan_to_num(found[2])


def _written(judged: Judgement, index: int) -> Written:
    found = less_sure(values_of(judged.physical.selection.best, index), judged.misfit)
    return Written(str(found["force"]), {k: one for k, one in found.items() if isinstance(one, Value)})


def _sum(terms: Iterator[str]) -> str:
    return " + ".join(terms).replace("+ -", "- ")


def _words(
    judged: Judgement, dof: str, terms: list[Written], depends_on: tuple[str, ...], at: Along, force: Floats
) -> str:
    on = enumerated(NAMES[name].format(dof=dof) for name in depends_on)
    size = bare(float(np.quantile(np.abs(force), 0.995)), 2)
    formula = _sum(one.told(with_std=True) for one in terms)
    law = law_of(formula, depends_on) if terms else TABLE
    seen = f", seen from {ranges}" if (ranges := ranges_of(domain_of(at, depends_on))) else ""
    energy = " It takes energy out." if takes_energy(force, at) else ""
    share = percent(min(max(judged.gone, 0.0), 1.0))
    return (
        f"A force of up to {size} N is missing at {dof} that depends on {on}: {law}{seen}.{energy} It is a "
        f"fitted law and explains {share} of the mismatch on unseen data."
    )
