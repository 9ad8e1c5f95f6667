"""Entries of a spec as they stand at an axis: with their units."""

from __future__ import annotations

UNITS = {
    "mass": "kg",
    "damping": "N s/m",
    "stiffness": "N/m",
    "force": "N",
    "pretension": "N",
    "amplitude": "N",
    "initial_position": "m",
    "initial_velocity": "m/s",
    "motor_poles": "rad/s",
    "frequency": "rad/s",
    "phase": "rad",
    "gap": "m",
    "position": "m",
    "velocity": "m/s",
    "delay": "s",
    "time_constant": "s",
}
"""Of the last part of a key."""


def label(key: str) -> str:
    """Key with its unit, as ``timing.tau4 (s)``; bare where the unit is not known.

    Examples
    --------
    >>> label("actuator.stiffness[0]")
    'actuator.stiffness[0] (N/m)'
    >>> label("timing.scale")
    'timing.scale (factor on all periods and delays)'
    """
    if key == "timing.scale":
        return f"{key} (factor on all periods and delays)"
    last = key.rpartition(".")[2].partition("[")[0]
    unit = "s" if key.startswith("timing.") else UNITS.get(last)
    return f"{key} ({unit})" if unit else key
