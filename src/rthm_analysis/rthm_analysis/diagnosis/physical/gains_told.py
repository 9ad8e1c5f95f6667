"""Sensors that read too much or too little, as findings."""

from __future__ import annotations

from collections.abc import Sequence

from rthm_analysis.diagnosis.faults.naming import BLOCKS, in_words
from rthm_analysis.diagnosis.faults.sensor_gains import SensorGain
from rthm_analysis.diagnosis.numbers import bare
from rthm_analysis.diagnosis.result import Part, Physics, Value
from rthm_analysis.diagnosis.words import physics_words
from rthm_core.effects.registry import changing
from rthm_core.spec.effect import placed


def gains_told(gains: Sequence[SensorGain]) -> Part:
    """What was taken out of some readings before anything else was looked for."""
    return Part(
        physics=tuple(_named(one) for one in gains),
        effects=tuple(_section(one) for one in gains),
        notes=tuple(_either(one) for one in gains if one.instead is not None),
    )


def _either(one: SensorGain) -> str:
    assert one.instead is not None
    inverse = bare(1.0 / one.factor, 4)
    return (
        f"It may as well be that {in_words(one.instead)} reads {inverse} times the true value: mass and "
        "stiffness are too uncertain to say which. Move the rig by a known distance."
    )


def _named(one: SensorGain) -> Physics:
    block, place = BLOCKS[one.channel.family], one.channel.place
    kind, key = _law(block)
    values: dict[str, Value | str] = {key: Value(one.factor, one.std, "1")}
    words = physics_words(block, kind, place, values, float("nan"), 0.0)
    return Physics(block, kind, place, values, words, 0.0, 0.0)


def _section(one: SensorGain) -> dict[str, object]:
    block = BLOCKS[one.channel.family]
    kind, key = _law(block)
    return {"block": block, "kind": kind, **placed(block, one.channel.place), key: one.factor}


def _law(block: str) -> tuple[str, str]:
    """The kind of a wrong gain, and its only parameter."""
    law = changing(block, "gain")
    (key,) = law.parameters
    return law.kind, key
