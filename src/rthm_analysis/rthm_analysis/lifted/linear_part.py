"""The linear part of a spec: what a loop is for motions so small, or so regular, that only its linear physics
acts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rthm_core.compensators import NAMES
from rthm_core.errors import InputError
from rthm_core.spec import apply
from rthm_core.spec.masses import mass_at, steady

if TYPE_CHECKING:
    from rthm_core.spec import Spec

"""Compensators whose linear equations are known here."""


def linear_part(spec: Spec) -> tuple[Spec, tuple[str, ...]]:
    """The loop without loads, noise, pretension and all effects that are not linear.

    Returns
    -------
    spec : Spec
        The linear loop.
    left_out : tuple of str
        One sentence for every effect, and every wire, whose nonlinear part was left out. A mass that depends
        on the position is what it is at rest.

    Raises
    ------
    InputError
        When the spec describes no loop, or has a compensator that is not linear or not known here.
    """
    check_compensator(str(spec.loop().actuator.compensator))
    kept, left_out = [], []
    carried = [one.name for one in steady(spec)]
    for one in spec.effects:
        if one.law.linear:
            kept.append(one.name)
        elif one.name in carried:
            left_out.append(f"{one.name} ({one.kind} of {one.place}) is taken as at rest.")
        elif not one.law.additive:
            left_out.append(f"{one.name} ({one.kind} of {one.place}) is not linear and is left out.")
    slack = [name for name, force in zip(spec.loop().actuator.names, _pretension(spec), strict=True) if force]
    left_out += [f"The wire of {name} is taken as never slack." for name in slack]
    changes = {
        "effects": kept,
        "actuator.pretension": [0.0] * len(spec.loop().actuator.names),
        "load.plant.kind": "none",
        "load.numerical.kind": "none",
        **{f"noise.{name}": 0.0 for name in ("position", "velocity", "motor", "force")},
    }
    if carried:
        at_rest = {"effects": carried, "plant.initial_position": [0.0] * spec.plant.n}
        changes["plant.mass"] = mass_at(apply(spec, at_rest), 0.0).ravel().tolist()
    return _changed(spec, changes), tuple(left_out)


def _changed(spec: Spec, changes: dict[str, Any]) -> Spec:
    """The spec itself where it is like this already."""
    now = {
        "effects": [one.name for one in spec.effects],
        "actuator.pretension": list(_pretension(spec)),
        **{f"load.{side}.kind": load.kind for side, load in spec.load.items() if load is not None},
        **{f"noise.{name}": value for name, value in spec.noise.items()},
    }
    different = {name: value for name, value in changes.items() if now.get(name) != value}
    return apply(spec, different) if different else spec


def check_compensator(name: str) -> None:
    """Refuse a compensator whose equations are not known here."""
    if name not in NAMES:
        raise InputError(
            f"actuator.compensator is {name!r}, whose linear equations are not known, but must be one of "
            f"{', '.join(NAMES)}; choose one of them, or simulate the loop."
        )


def _pretension(spec: Spec) -> tuple[float, ...]:
    return spec.loop().actuator.pretension
