"""The same motion in other units of length, time and mass.

A quantity of dimension L^a T^b M^c is multiplied by length^a time^b mass^c. Equations keep their form, so a
rig of micrometres and kilohertz is simulated as one of decimetres and seconds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from benchmarks.concealed.loop import EXTRA_PLANT, EXTRA_WIRE, W1, Recording

# Exponents of length, time and mass.
LENGTH, SPEED, FORCE = (1, 0, 0), (1, -1, 0), (1, -2, 1)
MASS, DAMPING, STIFFNESS = (0, 0, 1), (0, -1, 1), (0, -2, 1)
TIME, RATE, NUMBER = (0, 1, 0), (0, -1, 0), (0, 0, 0)
Dimension = tuple[int, int, int]

_PART = {
    "mass": MASS,
    "damping": DAMPING,
    "stiffness": STIFFNESS,
    "initial_position": LENGTH,
    "initial_velocity": SPEED,
}
_SPEC: dict[str, dict[str, Dimension]] = {
    "plant": _PART,
    "numerical": _PART,
    "interface": _PART,
    "actuator": {"stiffness": STIFFNESS, "motor_poles": RATE},
    "timing": dict.fromkeys(("td1", "td2", "td3", "td4", "tau1", "tau2", "tau3", "tau4"), TIME),
    "noise": {"position": LENGTH, "velocity": SPEED, "motor": LENGTH, "force": FORCE},
}
_LOAD = {"amplitude": FORCE, "frequency": RATE}

# Parameters of kinds; those of one name and two dimensions carry their kind.
_EFFECT: dict[str, Dimension] = {
    "force": FORCE, "coulomb_force": FORCE, "static_force": FORCE, "stribeck_velocity": SPEED,
    "quadratic_drag.coefficient": (-1, 0, 1), "cubic_stiffness.coefficient": (-2, -2, 1),
    "quadratic_stiffness.coefficient": (-1, -2, 1), "hardening.coefficient": (-2, -2, 1),
    "position": LENGTH, "stiffness": STIFFNESS, "damping": DAMPING, "gap": LENGTH, "alpha": STIFFNESS,
    "mass": MASS, "frequency": RATE, "gain": STIFFNESS, "amplitude": FORCE, "pretension": FORCE,
    "time_constant": TIME, "delay": TIME, "std": TIME, "offset": TIME, "limit": LENGTH,
    "rate_limit.rate": SPEED, "motor.step": LENGTH,
}  # fmt: skip
_CHANNELS = {"sensor.position": LENGTH, "sensor.velocity": SPEED, "sensor.force": FORCE}


@dataclass(frozen=True)
class Scale:
    """Units of a rig over those of the simulation: m, s, kg."""

    length: float = 1.0
    time: float = 1.0
    mass: float = 1.0

    def factor(self, of: Dimension) -> float:
        """What a quantity of this dimension is multiplied by."""
        return float(self.length ** of[0] * self.time ** of[1] * self.mass ** of[2])

    @property
    def channels(self) -> np.ndarray:
        """What x1, v1, u and F are multiplied by."""
        return np.array([self.factor(d) for d in (LENGTH, SPEED, LENGTH, FORCE)])

    def spec(self, spec: dict[str, Any]) -> dict[str, Any]:
        """Return a spec in the rig's units; its effects are left out."""
        out: dict[str, Any] = {}
        for section, values in spec.items():
            if section == "load":
                out[section] = {k: self._entries(v, _LOAD) for k, v in values.items()}
            elif section in _SPEC:
                out[section] = self._entries(values, _SPEC[section])
            elif section == "uncertainty":
                out[section] = values
        return out

    def _entries(self, values: dict[str, Any], dimensions: dict[str, Dimension]) -> dict[str, Any]:
        return {k: self._times(v, dimensions[k]) if k in dimensions else v for k, v in values.items()}

    def _times(self, value: Any, of: Dimension) -> Any:
        factor = self.factor(of)
        return [float(v) * factor for v in value] if isinstance(value, list) else float(value) * factor

    def effect(self, effect: dict[str, Any]) -> dict[str, Any]:
        """Return an effect of the library in the rig's units."""
        block, kind = effect["block"], effect["kind"]
        out = dict(effect)
        for key, value in effect.items():
            if isinstance(value, float):
                out[key] = value * self.factor(_of_effect(block, kind, key, effect))
        if kind == "bouc_wen":  # beta and gamma: |z|^-n
            for key in ("beta", "gamma"):
                out[key] = effect[key] * self.length ** -effect["n"]
        return out

    def recording(self, log: Recording) -> Recording:
        """Return a recording in the rig's units; instants stay whole nanoseconds."""
        x, v, F = (self.factor(d) for d in (LENGTH, SPEED, FORCE))
        plant = log.plant * np.array([x, v, x, F, x, v, x, F, F, F, F])
        assert (W1, EXTRA_PLANT, EXTRA_WIRE) == (8, 9, 10)
        return log._replace(
            plant=plant,
            numerical=log.numerical * np.array([x, v, F, F]),
            command=log.command * np.array([x, F]),
            command_stamp=self.instants(log.command_stamp),
            use=self.instants(log.use),
        )

    def instants(self, stamps: np.ndarray) -> np.ndarray:
        """Return instants, whole ns."""
        return stamps if self.time == 1.0 else np.rint(stamps * self.time).astype(np.int64)


def _of_effect(block: str, kind: str, key: str, effect: dict[str, Any]) -> Dimension:
    if kind == "wrong_parameter":
        section, name = effect["name"].split(".")
        return _SPEC[section][name]
    if block in _CHANNELS:
        a, b, c = _CHANNELS[block]
        special = {"bias": (a, b, c), "step": (a, b, c), "rate": (a, b - 1, c)}
        if key in special:
            return special[key]
    for name in (f"{kind}.{key}", f"{block}.{key}", key):
        if name in _EFFECT:
            return _EFFECT[name]
    return NUMBER
