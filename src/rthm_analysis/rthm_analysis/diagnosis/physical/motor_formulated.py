"""Formulas of motors that were earned, as findings: one for each motor."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.missing.binned import binned, spread_over
from rthm_analysis.diagnosis.missing.describe import VARIABLE_UNITS, ranges_of, symmetry_of
from rthm_analysis.diagnosis.numbers import bare, percent
from rthm_analysis.diagnosis.physical.driven import drives_earned
from rthm_analysis.diagnosis.physical.formulated import sum_of, written_of
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.physical.written import Written
from rthm_analysis.diagnosis.result import Described
from rthm_core.effects.formula import evaluated, parsed
from rthm_core.effects.written import MotorFormula


def motors_formulated(physical: Physical) -> Iterator[Described]:
    """What the formulas of the motors say, in the model of what they do."""
    if not drives_earned(physical.drives):
        return
    fitted, law = physical.drives[-1][0].fitted, MotorFormula
    places: dict[str, list[int]] = {}
    for index, one in enumerate(fitted.model.added):
        if one.law.written:
            places.setdefault(one.place, []).append(index)
    for actuator, indices in places.items():
        yield _of_motor(physical, actuator, [written_of(fitted, index, law.text) for index in indices])


def _of_motor(physical: Physical, actuator: str, terms: list[Written]) -> Described:
    """The error of a motor beside its command, over its command or time."""
    law, fitted = MotorFormula, physical.drives[-1][0].fitted
    effects = [one for one in fitted.model.added if one.law.written and one.place == actuator]
    depends_on = tuple(dict.fromkeys(name for one in effects for name in one.law.depends_on))
    on_command = law.depends_on[0] in depends_on
    motion = physical.experiment.motion(physical.settled, physical.windows)
    assert physical.spec.actuator is not None
    moved = motion.motor[:, physical.spec.actuator.names.index(actuator)]
    variables = {"u": moved, "t": physical.evidence.time}
    error = np.sum([evaluated(one.text, one.numbers, **variables) for one in terms], axis=0)
    over = variables["u" if on_command else "t"]
    at, mean, std, _ = binned(over, error)
    domain = {"u": (float(moved.min()), float(moved.max()))} if on_command else {}
    share = 1.0 - fitted.squares / physical.drives[0][-1].fitted.squares
    units = enumerated(f"{name} in {VARIABLE_UNITS[name]}" for name in _names(terms))
    seen = f", seen from {ranges_of(domain)}" if domain else ""
    size = bare(float(np.abs(error).max()), 2)
    words = (
        f"The motor of {actuator} goes up to {size} m beside its command u: it "
        f"goes to u + {sum_of(terms, with_std=True)}, with {units}{seen}. It is a fitted law and explains "
        f"{percent(share)} of what its sensor shows beside the command; the force of its wire follows."
    ).replace("+ -", "- ")
    return Described(
        law.blocks[0], actuator, depends_on, symmetry_of(at, mean) if on_command else "neither", False,
        False, None, sum_of(terms, with_std=False), domain, share, 0.0, at, mean, std, words,
        spread_over(over, error), unit="m",
    )  # fmt: skip


def _names(terms: Iterable[Written]) -> list[str]:
    return sorted({name for one in terms for name in parsed(one.text, MotorFormula.variables()).variables})
