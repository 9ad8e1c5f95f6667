"""Zeros of each recording's own, in words and as numbers."""

from __future__ import annotations

from collections.abc import Iterator

from rthm_analysis.diagnosis.enumerated import enumerated
from rthm_analysis.diagnosis.faults.naming import fault_of, in_words
from rthm_analysis.diagnosis.numbers import number
from rthm_analysis.diagnosis.physical.zeros import LOAD, OwnZeros, Zeros
from rthm_analysis.diagnosis.replay.evidence import UNIT_OF, Channel
from rthm_analysis.diagnosis.result import Fault, Value

OFFSET = "offset"
"""Kind of the fault."""


def zero_faults(own: OwnZeros | None, names: tuple[str, ...]) -> Iterator[Fault]:
    """A fault for every signal whose zero differs from recording to recording; `names` are theirs."""
    if own is None:
        return
    for k, target in enumerate(own.zeros.targets):
        what = f"{_head(target)} differs from recording to recording: {_each(own.zeros, k, names)}"
        words = f"{what}. That is no physics of the rig, and was taken out of each."
        yield fault_of(target, OFFSET, f"{words}{_beside(own.rival, names)}")


def zeros_in(own: OwnZeros | None, recording: int) -> dict[str, Value]:
    """What signals read at a true value of zero in one of the recordings, by name of the signal."""
    if own is None:
        return {}
    return {_name(one): _value(own.zeros, recording, k) for k, one in enumerate(own.zeros.targets)}


def _beside(rival: Zeros | None, names: tuple[str, ...]) -> str:
    """What the recordings do not tell it from."""
    if rival is None:
        return ""
    others = enumerated(f"{_inner(one)} ({_each(rival, k, names)})" for k, one in enumerate(rival.targets))
    return (
        f" They do not tell it from {others}: rest the rig under no force before each test, and note what "
        "every sensor reads."
    )


def _head(target: Channel) -> str:
    """What has a zero, at the beginning of a sentence."""
    if target.family == LOAD:
        return f"The constant force on {target.place}, or the zero of its load cell,"
    return f"The zero of {in_words(target)}"


def _inner(target: Channel) -> str:
    """The same at the end of one."""
    if target.family == LOAD:
        return f"a constant force on {target.place}, or an offset of its load cell"
    return f"the zero of {in_words(target)}"


def _each(zeros: Zeros, column: int, names: tuple[str, ...]) -> str:
    """The number of each recording; of a force that which acts, and not what its sensor reads too much."""
    said = []
    for recording, name in enumerate(names):
        one = _value(zeros, recording, column)
        sign = -1.0 if zeros.targets[column].family == LOAD else 1.0
        said.append(f"{number(sign * one.value, one.std, one.unit, signed=True)} in {name}")
    return enumerated(said)


def _value(zeros: Zeros, recording: int, column: int) -> Value:
    unit = "N" if zeros.targets[column].family == LOAD else UNIT_OF[zeros.targets[column].family]
    return Value(float(zeros.values[recording, column]), float(zeros.stds[recording, column]), unit)


def _name(target: Channel) -> str:
    """Name of a signal; of a known force that of its dof's load."""
    return f"load_{target.place}" if target.family == LOAD else target.signal
