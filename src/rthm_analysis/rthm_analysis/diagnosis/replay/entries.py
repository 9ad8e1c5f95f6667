"""Mass, damping, stiffness and wire by entries: what a plainer hypothesis than missing physics may change."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import ZERO_ENTRY_SCALE
from rthm_core.spec.sections import MATRICES

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.model import Parameter
    from rthm_core.spec import Spec

OF_PLANT = {f"plant.{name}": unit for name, unit in MATRICES.items()}
"""Matrices of the plant as a spec names them, and the units of their entries."""

MAY_DRIVE = ("plant.damping", "plant.stiffness")
"""Properties that may be below zero: a flow excites a rig, a column buckles."""

WIRE = "actuator.stiffness"

ENTRY = re.compile(r"(.+)\[(\d+)\]")


def entry_of(key: str) -> tuple[str, int] | None:
    """Property and place of a key such as ``plant.mass[0]``; None for other keys."""
    found = ENTRY.fullmatch(key)
    return (found[1], int(found[2])) if found else None


def entry_value(spec: Spec, key: str) -> float:
    """Value of an entry in a spec, in its unit."""
    name, place = entry_of(key) or (key, 0)
    return nominal_values(spec, name)[place]


def with_entry(spec: Spec, key: str, value: float) -> Spec:
    """Spec with another value of an entry; matrices stay symmetric."""
    found = entry_of(key)
    assert found is not None
    name, place = found
    section, _, field = name.partition(".")
    values = nominal_values(spec, name)
    values[place] = value
    if name in OF_PLANT:
        n = len(spec.plant.dofs)
        values[place % n * n + place // n] = value
    changed: dict[str, Any] = {field: tuple(values)}
    if section == "actuator":
        changed["transmission"] = None
    return spec.model_copy(update={section: getattr(spec, section).model_copy(update=changed)})


def uncertain_entries(spec: Spec, name: str, relative: float) -> Iterator[Parameter]:
    """Entries of a property that are not zero, each as uncertain as the spec says of the whole.

    Parameters
    ----------
    spec : Spec
    name : str
        ``plant.mass`` and so on, or that of the wires.
    relative : float
        Standard deviation over the value of the spec.
    """
    from rthm_analysis.diagnosis.replay.model import Parameter

    n = len(spec.plant.dofs)
    for place, value in enumerate(nominal_values(spec, name)):
        row, column = divmod(place, n) if name in OF_PLANT else (place, place)
        if not value or row > column:
            continue
        low = -np.inf if row != column or name in MAY_DRIVE else 1e-3 * value
        spread = relative * abs(value)
        yield Parameter(f"{name}[{place}]", value, spread, low, prior=(value, spread))


def free_entries(spec: Spec, frequency: float, *, commanded: bool, forced: bool) -> Iterator[Parameter]:
    """Every entry of mass, damping and stiffness, and every wire, whatever the spec says of its uncertainty.

    Parameters
    ----------
    spec : Spec
    frequency : float
        Where most of the recorded motion is, rad/s: gives entries of zero their scale.
    commanded : bool
        Whether recorded commands drive the plant, so that the wires show.
    forced : bool
        Whether anything known drives the plant (`Evidence.is_forced`); else the first mass is taken as it is.
    """
    from rthm_analysis.diagnosis.replay.model import Parameter

    assert spec.plant is not None
    n = len(spec.plant.dofs)
    mass = float(np.mean(np.diag(np.reshape(spec.plant.mass, (n, n)))))
    scales = {
        "mass": mass,
        "damping": 2.0 * ZERO_ENTRY_SCALE * mass * frequency,
        "stiffness": ZERO_ENTRY_SCALE * mass * frequency**2,
    }
    for name in OF_PLANT:
        for i in range(n):
            for j in range(i, n):
                key, value = f"{name}[{i * n + j}]", nominal_values(spec, name)[i * n + j]
                known = name == "plant.mass" and (i != j or (i == 0 and not forced))
                if known or (i != j and not value):
                    continue
                low = -np.inf if i != j or name in MAY_DRIVE else 1e-3 * value
                scale = max(abs(value), scales[name.partition(".")[2]])
                yield Parameter(key, value, scale, low)
    if commanded and spec.actuator is not None and spec.actuator.transmission is None:
        for i, value in enumerate(spec.k_tot):
            yield Parameter(f"{WIRE}[{i}]", float(value), float(value), 1e-3 * float(value))


def nominal_values(spec: Spec, key: str) -> list[float]:
    """Values of a property in the spec."""
    section, _, name = key.partition(".")
    values = spec.k_tot if key == WIRE else getattr(getattr(spec, section), name)
    return [float(value) for value in values]
