"""Our own ways through the same work, and loops beyond the paper's."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from rthm_core.clock import to_ns
from rthm_core.compiled import Floats
from rthm_core.engine import simulate
from rthm_core.engine.linear.run import kernel_call
from rthm_core.schedule import Schedule
from rthm_core.spec import Spec, apply, shipped_spec

WAVE = {"dof": "x1", "kind": "harmonic", "amplitude": 1.0, "frequency": 2.4, "phase": 0.3}
FRICTION = {"block": "plant", "dof": "x1", "kind": "coulomb_friction", "force": 0.05}
STRIBECK = {
    "block": "plant",
    "dof": "x1",
    "kind": "stribeck_friction",
    "coulomb_force": 0.05,
    "static_force": 0.1,
    "stribeck_velocity": 0.05,
}
CUBIC = {"block": "plant", "dof": "x1", "kind": "cubic_stiffness", "coefficient": 8.0}
HARDENING = {"block": "wire", "actuator": "a1", "kind": "hardening", "coefficient": 100.0}
SHAKY = {"block": "link.tau4", "kind": "jitter", "std": 0.001}


def whole(
    spec: Spec, duration: float, sample: float, *, energies: bool = False
) -> tuple[Callable[[], Any], Callable[[Any], Floats]]:
    """`simulate` as a user calls it."""
    return (
        lambda: simulate(spec, duration, sample, energies=energies),
        lambda found: np.asarray(found.plant_position[:, 0]),
    )


def kernel(spec: Spec, duration: float, sample: float) -> tuple[Callable[[], Any], Callable[[Any], Floats]]:
    """The compiled kernel alone, on prepared matrices and rows, as the C engine is called."""
    return kernel_call(spec, to_ns(duration), to_ns(sample)), lambda rows: np.asarray(rows.plant[:, 0])


def chain(n: int, m: int) -> Spec:
    """Two chains of `n` masses, joined at `m` of them."""

    def matrix(own: float, between: float) -> list[float]:
        k = np.diag(np.full(n, own + 2.0 * between)) - between * (np.eye(n, k=1) + np.eye(n, k=-1))
        return [float(entry) for entry in k.ravel()]

    def side(name: str, mass: float, start: float) -> dict[str, Any]:
        return {
            f"{name}.dofs": [f"{name[0]}{i + 1}" for i in range(n)],
            f"{name}.mass": [float(x) for x in (mass * np.eye(n)).ravel()],
            f"{name}.damping": matrix(0.05, 0.02),
            f"{name}.stiffness": matrix(12.0, 6.0),
            f"{name}.initial_position": [start] + [0.0] * (n - 1),
            f"{name}.initial_velocity": [0.0] * n,
        }

    joined = {
        "interface.plant_dof": [f"p{i + 1}" for i in range(m)],
        "interface.numerical_dof": [f"n{i + 1}" for i in range(m)],
        "interface.stiffness": [6.0] * m,
        "interface.damping": [0.1] * m,
        "load.plant.dof": "p1",
        "load.numerical.dof": "n1",
        "actuator.names": [f"a{i + 1}" for i in range(m)],
        "actuator.stiffness": [40.0] * m,
        "actuator.pretension": [0.0] * m,
    }
    return apply(shipped_spec("paper"), side("plant", 1.2, 0.1) | side("numerical", 1.5, 0.0) | joined)


def further(paper: Spec) -> dict[str, Spec]:
    """Loops beyond the paper's, by what they add."""
    return {
        "motor poles": apply(paper, {"actuator.motor_poles": [400.0, 2000.0]}),
        "harmonic load": apply(paper, {"load.plant": WAVE}),
        "n = 10, m = 3": chain(10, 3),
        "jitter in tau4": apply(paper, {"effects": ["shaky"], "shaky": SHAKY}),
        "sensor noise": apply(paper, {"noise.position": 1e-4, "noise.velocity": 2e-3}),
    }


def repeating(paper: Spec) -> dict[str, Spec]:
    """Those of `further` whose events repeat and that add no noise: linear all through."""
    return {name: spec for name, spec in further(paper).items() if not spec.effects and not any_noise(spec)}


def any_noise(spec: Spec) -> bool:
    """Whether a sensor has noise."""
    return bool(spec.noise.position or spec.noise.velocity or spec.noise.force)


def nonlinear(paper: Spec) -> dict[str, Spec]:
    """Loops with a plant that is not linear, by what it has."""
    parts = {
        "Coulomb friction": {"guide": FRICTION},
        "Stribeck friction": {"guide": STRIBECK},
        "Coulomb friction, cubic spring": {"guide": FRICTION, "spring": CUBIC},
        "wire that hardens": {"wire": HARDENING},
    }
    return {name: apply(paper, {"effects": list(part), **part}) for name, part in parts.items()}


def difference(spec: Spec, duration: float, sample: float) -> float:
    """Largest difference of x1, in m, from the engine that takes any loop."""
    found = simulate(spec, duration, sample, energies=False)
    other = simulate(spec, duration, sample, energies=False, schedule=Schedule(spec))
    return float(np.abs(found.plant_position - other.plant_position).max())
