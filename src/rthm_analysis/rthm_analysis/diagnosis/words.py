"""What was found, in words for a test engineer."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from rthm_analysis.diagnosis.criteria.words import (
    AT_BOUND_SHARE,
    BOUND_STD_RATIO,
    DRIVING_STDS,
    EXACT_STD_DIGITS,
    FAR_STDS,
    SLIGHT_CHANGE,
)
from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.numbers import bare, number, percent, with_unit
from rthm_analysis.diagnosis.result import Described, Fault, Physics, Retuned, Trace, Value
from rthm_core.effects import Effect, EffectText, effect

if TYPE_CHECKING:
    from rthm_core.spec import Spec

__all__ = [
    "bare",
    "block_words",
    "number",
    "percent",
    "physics_words",
    "retuned_words",
    "stated_spreads",
    "verdict_words",
]

BLOCK_WORDS = {
    "plant": "the physical substructure",
    "wire": "the wire",
    "motor": "the motor",
    "numerical": "the numerical substructure",
    "controller": "the controller",
    "sensor.position": "the position sensor",
    "sensor.velocity": "the velocity sensor",
    "sensor.acceleration": "the accelerometer",
    "sensor.force": "the force sensor",
}

LATE_MOTOR = " Compare timing.tau4 in the spec with the delays that the drive and its node were set to."
"""What to look at where software rather than the motor may be the reason."""


SPREAD = "+- is one standard deviation."
ABOVE = "This explains a part of the difference; the rest is above the noise."


def block_words(block: str) -> str:
    """A block's name in a sentence."""
    return f"the link {block.removeprefix('link.')}" if block.startswith("link.") else BLOCK_WORDS[block]


def physics_words(
    block: str, kind: str, place: str, parameters: dict[str, Value | str], share: float, energy: float
) -> str:
    """What, where, how big, how sure, how much it explains, and what it costs."""
    declared = effect(kind, block)
    sizes = {
        key: v if isinstance(v, str) else _size(declared, key, _in_numbers(v, parameters))
        for key, v in parameters.items()
    }
    said = declared.describe(block_words(block) if block.startswith("sensor.") else block, place, sizes)
    further = [f"{_name(key)} {size}" for key, size in sizes.items() if f"{{{key}}}" not in declared.words]
    more = f" ({', '.join(further)})" if further else ""
    text = f"{said[:1].upper()}{said[1:]}{more}."
    text += "".join(_at_bound(declared, key, v) for key, v in parameters.items() if isinstance(v, Value))
    text += LATE_MOTOR if block == "motor" and declared.changes == "delay" else ""
    if math.isfinite(share) and share > 0.0:
        text += f" It removes {percent(share)} of the squared error on data that the fit has not seen."
    if math.isfinite(energy) and energy:
        way = "put in" if energy > 0.0 else "took out"
        text += f" Over the recording it {way} {bare(abs(energy))} J."
    return text


def _size(declared: type[Effect], key: str, value: Value) -> str:
    entry = declared.parameters[key]
    positive = not isinstance(entry, EffectText) and entry.lowest is not None and entry.lowest >= 0.0
    return number(value.value, value.std, value.unit, signed=not positive)


def _in_numbers(value: Value, parameters: Mapping[str, Value | str]) -> Value:
    """The value with the exponent n in its unit as a number: ``1/m^1.5``."""
    n = parameters.get("n")
    if not value.unit.endswith("^n") or not isinstance(n, Value):
        return value
    power = bare(n.value, 2)
    return replace(value, unit=value.unit.removesuffix("^n") + (f"^{power}" if power != "1" else ""))


def _at_bound(declared: type[Effect], key: str, value: Value) -> str:
    """Sentence about a value that has run into the end of what is possible."""
    entry = declared.parameters[key]
    if isinstance(entry, EffectText):
        return ""
    for bound, which in ((entry.lowest, "smallest"), (entry.highest, "largest")):
        if bound and abs(value.value - bound) <= AT_BOUND_SHARE * abs(bound):
            return f" Its {_name(key)} is the {which} that is possible."
    return ""


def _name(key: str) -> str:
    return key.replace("_", " ")


def retuned_words(retuned: Mapping[str, Retuned], stated: Mapping[str, float] | None = None) -> str:
    """New values of uncertain parameters in one sentence.

    Parameters
    ----------
    retuned : mapping of Retuned
    stated : mapping of float, optional
        Relative standard deviation that the spec states for ``plant.mass`` and so on; 0: exact. Where it is
        given, a value that is far from what it allows is said to be so.
    """
    changed = {name: one for name, one in retuned.items() if not _is_slight(one)}
    return "; ".join(_retuned(name, one, stated) for name, one in (changed or retuned).items())


def _is_slight(one: Retuned) -> bool:
    return abs(one.value - one.nominal) < SLIGHT_CHANGE * abs(one.nominal)


def _retuned(name: str, one: Retuned, stated: Mapping[str, float] | None) -> str:
    key = name.partition("[")[0]
    unit = one.unit
    value = number(one.value, one.std, unit, size=one.nominal)
    specified = _specified(one, value, unit)
    if not specified:
        return f"{name} as specified, {value}"
    if _is_slight(one) and abs(one.value - one.nominal) <= one.std:
        return f"{name} {value}, as specified"
    text = f"{name} {value} instead of {specified}"
    if not one.nominal or one.std > BOUND_STD_RATIO * abs(one.value):
        return text
    change = one.value / one.nominal - 1.0
    remarks = [_change(change), _remark(change, stated, key), _drives(one, key)]
    return f"{text} ({', '.join(one for one in remarks if one)})"


def _specified(one: Retuned, value: str, unit: str) -> str:
    """The value of the spec with the digits that it takes to tell it from the new one, as that is written;
    empty where nothing does.
    """
    texts = (with_unit(one.nominal, unit, digits) for digits in range(4, max(EXACT_STD_DIGITS.values()) + 1))
    return next((text for text in texts if text != value), "")


def _change(change: float) -> str:
    """Relative change in words: ``-3.0 %``."""
    if abs(change) < SLIGHT_CHANGE:
        return f"less than {percent(SLIGHT_CHANGE)} off"
    return f"{100.0 * change:+.{1 if abs(change) < 1.0 else 0}f} %"


def _remark(change: float, stated: Mapping[str, float] | None, key: str) -> str:
    """How a relative change agrees with what the spec states."""
    if stated is None or key not in stated:
        return ""
    spread = stated[key]
    if spread <= 0.0 and abs(change) >= SLIGHT_CHANGE:
        return "though the spec calls it exact"
    if abs(change) > FAR_STDS * spread > 0.0:
        return f"{bare(abs(change) / spread, 2)} times the uncertainty that the spec states"
    return ""


def _drives(one: Retuned, key: str) -> str:
    """What it means that a damping or a stiffness is below zero, where it surely is and the spec's is not, as
    are those that couple two dofs.
    """
    if one.value > -DRIVING_STDS * one.std or one.nominal < 0.0:
        return ""
    if key.startswith("plant.damping"):
        return "below zero: something feeds energy in, as a flow, a control or a delay does"
    if key.startswith("plant.stiffness"):
        return "below zero: it pushes away from the middle, as what has buckled does"
    return ""


def stated_spreads(spec: Spec) -> dict[str, float]:
    """Relative standard deviation that a spec states for each property; 0: exact."""
    blocks = [(block, dict(section.items())) for block, section in spec.uncertainty.items()]
    blocks += [(one.name, one.uncertainty) for one in spec.effects]
    return {f"{block}.{key}": float(value) for block, stated in blocks for key, value in stated.items()}


def verdict_words(
    verdict: str,
    located: tuple[str, ...],
    physics: tuple[Physics, ...],
    retuned: dict[str, Retuned],
    stated: Mapping[str, float] | None = None,
    faults: tuple[Fault, ...] = (),
    described: tuple[Described, ...] = (),
    traces: tuple[Trace, ...] = (),
) -> str:
    """The answer in a few sentences; `stated` as in `retuned_words`."""
    new_values = retuned_words(retuned, stated) if retuned else ""
    if verdict == "match":
        answer = [
            "Simulation and recording agree to within the noise: "
            "nothing is missing that this recording could show."
        ]
    elif verdict == "retuned":
        answer = [f"No physics is missing; parameters have other values than the spec says: {new_values}."]
    else:
        answer = [_where(verdict, located), *(one.words for one in physics)]
        answer += [f"Besides, {new_values}."] if new_values and verdict != "unexplained" else []
    answer += [one.words for one in described]
    answer += [ABOVE] if verdict == "improved" and (physics or new_values) else []
    answer += [f"Also detectable, though it matters little: {one.words}" for one in traces]
    answer += [f"({SPREAD})"] if any("+-" in said for said in answer) else []
    return " ".join([*answer, *(one.words for one in faults)])


def _where(verdict: str, located: tuple[str, ...]) -> str:
    where = enumerated(block_words(block) for block in located)
    known = ", and no known kind of physics explains it" if verdict == "unexplained" else ""
    return f"Simulation and recording differ in {where}{known}."
