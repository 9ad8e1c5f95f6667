"""The effects to conceal and their families."""

from __future__ import annotations

from collections.abc import Callable

from benchmarks.concealed import amounts as of
from benchmarks.concealed.amounts import Scene, Values

SIZES = (0.02, 0.05, 0.15)
COMPUTED = (
    "numerical.mass",
    "numerical.damping",
    "numerical.stiffness",
    "interface.stiffness",
    "interface.damping",
)
SENSORS = ("sensor.position", "sensor.velocity", "sensor.force")
LINKS = ("link.tau1", "link.tau2", "link.tau3", "link.tau4")

CATALOGUE: dict[tuple[str, str], Callable[[float, Scene], Values]] = {
    ("plant", "coulomb_friction"): lambda size, s: {"force": size * s.F},
    ("plant", "stribeck_friction"): of.stribeck,
    ("plant", "quadratic_drag"): of.drag,
    ("plant", "cubic_stiffness"): of.cube,
    ("plant", "quadratic_stiffness"): of.square,
    ("plant", "end_stop"): of.end_stop,
    ("plant", "clearance"): of.clearance,
    ("plant", "bouc_wen"): lambda size, s: of.bouc_wen(size, s, s.x, int(s.rng.integers(1, 3))),
    ("plant", "maxwell_branch"): lambda size, s: of.branch(size * s.F, s.x, s),
    ("plant", "hidden_mode"): of.hidden,
    ("plant", "fluid_memory"): of.fluid,
    ("plant", "harmonic_load"): of.harmonic,
    ("plant", "constant_load"): lambda size, s: {"force": s.sign() * size * s.F},
    ("plant", "mass_change"): of.mass_change,
    ("plant", "growing_mass"): of.growing_mass,
    ("wire", "backlash"): lambda size, s: {"gap": 2.0 * size * s.d},
    ("wire", "slack"): lambda size, s: {"pretension": s.level(3, 2.0 * size)},
    ("wire", "hardening"): of.hardening,
    ("wire", "pulley_inertia"): lambda size, s: of.pulley(size, s),
    ("wire", "pulley_friction"): lambda size, s: {"force": 2.0 * size * s.F},
    ("wire", "bouc_wen"): lambda size, s: of.bouc_wen(size, s, s.d, 1),
    ("wire", "maxwell_branch"): lambda size, s: of.branch(size * s.F, s.d, s),
    ("motor", "lag"): lambda size, s: {"time_constant": 0.03 * size * s.between(0.7, 1.4)},
    ("motor", "second_order"): of.second_order,
    ("motor", "extra_delay"): lambda size, s: {"delay": 0.03 * size * s.between(0.7, 1.4)},
    ("motor", "rate_limit"): lambda size, s: {"rate": s.level(1, 2.0 * size) * s.between(0.9, 1.3)},
    ("motor", "saturation"): lambda size, s: {"limit": s.level(2, size)},
    ("motor", "quantisation"): lambda size, s: {"step": 0.004 * size * s.between(0.7, 1.4)},
    ("link.*", "extra_delay"): lambda size, s: {"delay": 0.05 * size * s.between(0.7, 1.4)},
    ("link.*", "jitter"): lambda size, s: {"std": 0.04 * size * s.between(0.7, 1.4)},
    ("link.*", "loss"): lambda size, s: {"fraction": size * s.between(0.7, 1.4)},
    ("link.*", "clock_offset"): lambda size, s: {"offset": 0.05 * size * s.between(0.7, 1.4)},
    ("sensor.*", "bias"): lambda size, s: {"bias": s.sign() * size},
    ("sensor.*", "scale"): lambda size, s: {"scale": 1.0 + s.sign() * min(size, 0.08)},
    ("sensor.*", "drift"): lambda size, s: {"rate": s.sign() * size / 60.0},
    ("sensor.*", "lag"): lambda size, s: {"time_constant": 0.06 * size * s.between(0.7, 1.4)},
    ("sensor.*", "quantisation"): lambda size, s: {"step": 0.5 * size},
    ("numerical", "wrong_parameter"): of.wrong(COMPUTED),
    ("controller", "wrong_parameter"): of.wrong(("actuator.stiffness",)),
}  # fmt: skip

PAIRS = (
    (("plant", "coulomb_friction"), ("plant", "cubic_stiffness")),
    (("plant", "quadratic_drag"), ("motor", "extra_delay")),
    (("plant", "end_stop"), ("wire", "slack")),
)

TRIPLES = (
    (("plant", "coulomb_friction"), ("plant", "quadratic_drag"), ("plant", "cubic_stiffness")),
    (("plant", "coulomb_friction"), ("plant", "quadratic_stiffness"), ("wire", "backlash")),
    (("plant", "quadratic_drag"), ("plant", "cubic_stiffness"), ("wire", "slack")),
    (("plant", "coulomb_friction"), ("plant", "quadratic_drag"), ("plant", "end_stop")),
    (("plant", "quadratic_drag"), ("plant", "cubic_stiffness"), ("wire", "pulley_friction")),
)

_FAMILIES = {
    "friction": ("coulomb_friction", "stribeck_friction", "pulley_friction"),
    "drag": ("quadratic_drag",),
    "stiffness": ("cubic_stiffness", "quadratic_stiffness", "hardening"),
    "contact": ("end_stop", "clearance", "slack", "backlash"),
    "hysteresis": ("bouc_wen",),
    "memory": ("maxwell_branch", "hidden_mode", "fluid_memory", "pulley_inertia"),
    "load": ("harmonic_load", "constant_load"),
    "varying": ("mass_change", "growing_mass"),
    "motor dynamics": ("lag", "second_order", "extra_delay"),
    "motor limits": ("rate_limit", "saturation", "quantisation"),
}


def family(block: str, kind: str) -> str:
    """Family of an effect: by block where the block says it all, else by kind."""
    for prefix in ("link", "sensor"):
        if block.startswith(prefix):
            return prefix
    if kind == "wrong_parameter":
        return "parameter"
    return next((name for name, kinds in _FAMILIES.items() if kind in kinds), kind)


def make_effect(block: str, kind: str, size: float, scene: Scene) -> Values:
    """Effect in the words of the spec, four digits kept."""
    section = block.split(".")[0]
    key = (f"{section}.*" if section in ("link", "sensor") else section, kind)
    effect: Values = {"block": block, "kind": kind}
    if block in ("plant", "sensor.position", "sensor.velocity"):
        effect["dof"] = "x1"
    elif block in ("wire", "motor", "sensor.force"):
        effect["actuator"] = "a1"
    values = CATALOGUE[key](size * _unit(block, kind, scene), scene)
    return effect | {k: v if isinstance(v, str) else float(f"{v:.4g}") for k, v in values.items()}


def _unit(block: str, kind: str, scene: Scene) -> float:
    """What a size of 1 is for a sensor's additive effects, in its unit; 1 for all others."""
    if kind in ("bias", "drift", "quantisation"):
        return {"sensor.position": 0.04, "sensor.velocity": 0.5, "sensor.force": 3.0}.get(block, 1.0)
    return 1.0
