"""What is hidden in the plant of the test `paper` with reference noise: one effect in each run."""

from __future__ import annotations

from typing import Any

from rthm_core.spec import Spec, apply

HIDDEN: tuple[tuple[str, str, dict[str, float]], ...] = (
    ("plant", "coulomb_friction", {"force": 0.05}),
    ("plant", "quadratic_drag", {"coefficient": 0.3}),
    ("plant", "cubic_stiffness", {"coefficient": 6.0}),
    ("plant", "end_stop", {"position": 0.25, "stiffness": 20.0, "damping": 0.1}),
    ("plant", "bouc_wen", {"alpha": 3.0, "A": 1.0, "beta": 8.0, "gamma": 4.0, "n": 1.0}),
    ("wire", "backlash", {"gap": 0.004}),
    ("wire", "slack", {"pretension": 2.0}),
    ("motor", "lag", {"time_constant": 0.003}),
    ("motor", "extra_delay", {"delay": 0.003}),
    ("sensor.force", "scale", {"scale": 1.05}),
)


def hidden(nominal: Spec, block: str, kind: str, parameters: dict[str, float]) -> Spec:
    """Spec of the test with one effect."""
    place = {"dof": "x1"} if block == "plant" else {"actuator": "a1"}
    section: dict[str, Any] = {"block": block, "kind": kind, **place, **parameters}
    return apply(nominal, {"effects": ["hidden"], "hidden": section})
