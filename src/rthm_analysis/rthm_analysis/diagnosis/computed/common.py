"""What the diagnoses of both computing blocks share."""

from __future__ import annotations

from rthm_analysis.diagnosis.result import Part, Physics, Value
from rthm_core.effects.registry import changing


def wrong_kind(block: str) -> str:
    """Kind of effect by which a block computes with another value than the spec's."""
    return changing(block, "entry").kind


def unchecked(block: str, reason: str) -> Part:
    """Return a part that says why a block was not checked."""
    return Part(notes=(f"{block}: {reason}, so what it computes with was not checked.",))


def effect_of(block: str, one: Physics) -> dict[str, object]:
    """Section of a spec in which a block has a wrong parameter."""
    value = one.parameters["value"]
    number = value.value if isinstance(value, Value) else value
    parameters = {"name": one.parameters["name"], "value": number}
    return {"block": block, "kind": one.kind, "parameters": parameters}
