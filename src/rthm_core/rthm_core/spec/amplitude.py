"""A test with smaller motion: the stage between a machine that stands and the whole test."""

from __future__ import annotations

import math
from typing import Any

from rthm_core.errors import InputError, refusal
from rthm_core.spec.changes import apply
from rthm_core.spec.schema import Spec

LOADS = {"constant": "force", "harmonic": "amplitude", "multisine": "rms"}
"""Which number of a load says how large it is."""


def scaled_motion(spec: Spec, amplitude: float) -> Spec:
    """Return the spec with loads and initial motion times `amplitude`; delays, limits and physics stay.

    A loop that is linear then moves `amplitude` times as far.

    Raises
    ------
    InputError
        If the amplitude is not above zero, or a load is a file, which has its own size.

    Examples
    --------
    >>> from rthm_core.spec import shipped_spec
    >>> scaled_motion(shipped_spec("paper"), 0.1).plant.initial_position
    (0.05,)
    """
    if not (math.isfinite(amplitude) and amplitude > 0.0):
        raise refusal("--amplitude", amplitude, "a number above 0", "1 is the whole test")
    if amplitude == 1.0:
        return spec
    changes: dict[str, Any] = {}
    for side in ("plant", "numerical"):
        changes |= _motion(spec, side, amplitude) | _load(spec, side, amplitude)
    return apply(spec, changes)


def _motion(spec: Spec, side: str, amplitude: float) -> dict[str, Any]:
    given = getattr(spec, side)
    if given is None:
        return {}
    return {
        f"{side}.{name}": [amplitude * value for value in getattr(given, name)]
        for name in ("initial_position", "initial_velocity")
    }


def _load(spec: Spec, side: str, amplitude: float) -> dict[str, Any]:
    load = getattr(spec.load, side) if spec.load else None
    if load is None or load.kind == "none":
        return {}
    if load.kind not in LOADS:
        raise InputError(
            f"load.{side} is a {load.kind}, which --amplitude cannot scale; scale the forces in it instead."
        )
    name = LOADS[load.kind]
    return {f"load.{side}.{name}": amplitude * getattr(load, name)}
