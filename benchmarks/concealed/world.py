"""From a spec, in the words of the contract, to the numbers that the loop computes with."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from benchmarks.concealed.links import Link, make_link
from benchmarks.concealed.loads import tabulate
from benchmarks.concealed.motion import World
from benchmarks.concealed.motor import Motor
from benchmarks.concealed.numerical import Numerical
from benchmarks.concealed.plant import Plant
from benchmarks.concealed.sensors import Sensor
from benchmarks.concealed.strange import CODES, HIDDEN_LOADS
from benchmarks.concealed.wire import Wire

NO_SINES = np.zeros((0, 3))
CHANNELS = ("position", "velocity", "motor", "force")  # of the reference noise
REFERENCE_NOISE = {"position": 1e-4, "velocity": 2e-3, "motor": 1e-5, "force": 0.02}

# Parameter of an effect -> field of the tuple of its block, where the names differ.
FIELDS: dict[tuple[str, str], dict[str, str]] = {
    ("plant", "stribeck_friction"): {},
    ("plant", "quadratic_drag"): {"coefficient": "drag"},
    ("plant", "cubic_stiffness"): {"coefficient": "cubic"},
    ("plant", "quadratic_stiffness"): {"coefficient": "quadratic"},
    ("plant", "end_stop"): {
        "position": "stop_position",
        "stiffness": "stop_stiffness",
        "damping": "stop_damping",
    },
    ("plant", "clearance"): {"gap": "clearance_gap", "stiffness": "clearance_stiffness"},
    ("plant", "bouc_wen"): {},
    ("plant", "maxwell_branch"): {"stiffness": "branch", "damping": "branch_damping"},
    ("plant", "hidden_mode"): {
        "mass": "hung_mass",
        "frequency": "hung_frequency",
        "damping_ratio": "hung_damping_ratio",
    },
    ("plant", "fluid_memory"): {
        "gain": "wave_gain",
        "frequency": "wave_frequency",
        "damping_ratio": "wave_damping_ratio",
    },
    ("plant", "mass_change"): {
        "change": "joining",
        "at": "joining_at",
        "within": "joining_within",
    },
    ("plant", "growing_mass"): {"rate": "growing", "at": "growing_from"},
    ("plant", "harmonic_load"): {
        "amplitude": "load_amplitude",
        "frequency": "load_frequency",
        "phase": "load_phase",
    },
    ("plant", "constant_load"): {"force": "load_constant"},
    ("wire", "backlash"): {},
    ("wire", "slack"): {},
    ("wire", "hardening"): {"coefficient": "hardening"},
    ("wire", "pulley_inertia"): {"mass": "pulley_mass", "damping": "pulley_damping"},
    ("wire", "pulley_friction"): {"force": "rub"},
    ("wire", "bouc_wen"): {},
    ("wire", "maxwell_branch"): {"stiffness": "branch", "damping": "branch_damping"},
    ("motor", "lag"): {"time_constant": "lag"},
    ("motor", "second_order"): {},
    ("motor", "rate_limit"): {},
    ("motor", "saturation"): {},
    ("motor", "quantisation"): {},
    ("wire", "limp_wire"): {},
    ("wire", "bending_wire"): {},
    ("motor", "screw_error"): {},
    ("motor", "creeping_motor"): {},
}
AT_REST: dict[type, dict[str, Any]] = {  # what is not zero where an effect is absent
    Plant: {
        "stribeck_velocity": 1.0,
        "stop_position": np.inf,
        "clearance_gap": np.inf,
        "branch_damping": 1.0,
        "n": 1.0,
        "strange": np.zeros(2),
        "hidden_load": np.zeros((2, 2)),
    },
    Wire: {"pretension": np.inf, "branch_damping": 1.0, "n": 1.0},
    Motor: {"rate": np.inf, "limit": np.inf},
}


@dataclass
class HybridTest:
    """The spec and what a spec cannot say.

    Parameters
    ----------
    spec
        The contract's `ros__parameters`, with the effects that really act.
    sines1, sines2
        Known loads: rows of amplitude (N), frequency (rad/s), phase.
    ramp1, ramp2
        Seconds over which the loads fade in.
    start
        When they begin, s.
    """

    spec: dict[str, Any]
    sines1: np.ndarray = field(default_factory=lambda: NO_SINES)
    ramp1: float = 0.0
    sines2: np.ndarray = field(default_factory=lambda: NO_SINES)
    ramp2: float = 0.0
    start: float = 0.0


def ns(seconds: float) -> int:
    """Whole nanoseconds."""
    return round(seconds * 1e9)


def effects_of(spec: dict[str, Any], block: str = "", kind: str = "") -> list[dict[str, Any]]:
    """Effects of a block and kind; all where a name is empty."""
    found = [spec[name] for name in spec.get("effects", [])]
    return [e for e in found if block in ("", e["block"]) and kind in ("", e["kind"])]


def wire_stiffness(actuator: dict[str, Any]) -> float:
    """k_tot, with a transmission by the corrected (5): 1 / (1/k_w + r_w^2/k_theta)."""
    if "transmission" not in actuator:
        return float(actuator["stiffness"][0])
    gear = actuator["transmission"]
    return 1.0 / (1.0 / gear["wire"] + gear["radius"] ** 2 / gear["spring"])


def parameters(effect: dict[str, Any]) -> dict[str, float]:
    """Parameters of an effect, by name."""
    return {k: float(v) for k, v in effect.items() if k not in ("block", "kind", "dof", "actuator", "name")}


def _fill(kind: type, block: str, spec: dict[str, Any], **known: float) -> Any:
    """Tuple of a block: absent parts, then `known`, then its effects."""
    values = dict.fromkeys(kind._fields, 0.0) | AT_REST[kind] | known
    for effect in effects_of(spec, block):
        if effect["kind"] == "coulomb_friction":
            values |= dict.fromkeys(("coulomb_force", "static_force"), float(effect["force"]))
        elif effect["kind"] in CODES:
            values["strange"] = np.array([CODES[effect["kind"]], *effect["values"]])
        elif effect["kind"] in HIDDEN_LOADS:
            values["hidden_load"] = tabulate(np.array(effect["sines"]), 0.0, effect["until"])
        elif effect["kind"] != "extra_delay":
            names = FIELDS[block, effect["kind"]]
            values |= {names.get(k, k): v for k, v in parameters(effect).items()}
    return kind(**{k: v if isinstance(v, np.ndarray) else float(v) for k, v in values.items()})


def _wire(spec: dict[str, Any]) -> Wire:
    actuator = spec["actuator"]
    k = wire_stiffness(actuator)
    known = {"stiffness": k, "motor_side": 2.0 * k, "plant_side": 2.0 * k}
    if "transmission" in actuator:  # (3a), with the pulley's turn times its radius as its position
        gear = actuator["transmission"]
        square = gear["radius"] ** 2
        known |= {"motor_side": gear["spring"] / square, "plant_side": gear["wire"]}
        known |= {"pulley_mass": gear["inertia"] / square, "pulley_damping": gear["damping"] / square}
    return _fill(Wire, "wire", spec, **known)


def _numerical(spec: dict[str, Any]) -> Numerical:
    values = {f"numerical.{k}": spec["numerical"][k][0] for k in ("mass", "damping", "stiffness")}
    values |= {f"interface.{k}": spec["interface"][k][0] for k in ("stiffness", "damping")}
    values |= {e["name"]: e["value"] for e in effects_of(spec, "numerical", "wrong_parameter")}
    return Numerical(*(float(v) for v in values.values()))


def controller_stiffness(spec: dict[str, Any]) -> float:
    """The k_tot that the controller divides by."""
    wrong = effects_of(spec, "controller", "wrong_parameter")
    return float(wrong[0]["value"]) if wrong else wire_stiffness(spec["actuator"])


def _lag(spec: dict[str, Any], channel: str) -> float:
    found = effects_of(spec, f"sensor.{channel}", "lag")
    return float(found[0]["time_constant"]) if found else 0.0


def make_world(test: HybridTest, duration: float) -> World:
    """Everything that moves."""
    spec = test.spec
    plant = {k: spec["plant"][k][0] for k in ("mass", "damping", "stiffness")}
    poles = dict(zip(("kv", "ka"), spec["actuator"].get("motor_poles", ()), strict=False))
    lags = [_lag(spec, channel) for channel in ("position", "velocity", "force")]
    motor = _fill(Motor, "motor", spec, **poles)
    loads = (
        tabulate(sines, ramp, duration, test.start)
        for sines, ramp in ((test.sines1, test.ramp1), (test.sines2, test.ramp2))
    )
    return World(_fill(Plant, "plant", spec, **plant), _wire(spec), motor, _numerical(spec), *loads, *lags)


def make_sensors(spec: dict[str, Any], noisy: bool) -> tuple[Sensor, ...]:
    """Sensors of x1, v1, u and F with the contract's reference noise."""
    out = []
    for channel in CHANNELS:
        values = {"lag": _lag(spec, channel), "scale": 1.0, "bias": 0.0, "drift": 0.0, "step": 0.0}
        for effect in effects_of(spec, f"sensor.{channel}"):
            if effect["kind"] != "lag":
                values |= {{"rate": "drift"}.get(k, k): v for k, v in parameters(effect).items()}
        out.append(Sensor(**values, noise=REFERENCE_NOISE[channel] if noisy else 0.0))
    return tuple(out)


def make_links(
    spec: dict[str, Any], samples: tuple[int, int, int, int], rng: np.random.Generator, lateness: float
) -> tuple[Link, ...]:
    """The links tau1 to tau4; `lateness` (s): mean of an exponential extra delay, as on a busy machine."""
    out = []
    for i, n in enumerate(samples, 1):
        block = f"link.tau{i}"
        late = rng.exponential(lateness, n) if lateness > 0.0 else np.zeros(n)
        lost = np.zeros(n, dtype=np.bool_)
        for effect in effects_of(spec, block):
            value = parameters(effect)
            late += (
                value.get("delay", 0.0)
                + value.get("offset", 0.0)
                + np.abs(rng.normal(0.0, 1.0, n)) * value.get("std", 0.0)
            )
            late += value.get("drift", 0.0) * np.linspace(0.0, 1.0, n)
            lost |= rng.random(n) < value.get("fraction", 0.0)
            if effect["kind"] == "outage":
                lost |= np.abs(np.linspace(0.0, 1.0, n) - value["centre"]) < 0.5 * value["width"]
        if i == 4:
            late += motor_delay(spec)
        out.append(make_link(ns(spec["timing"][f"tau{i}"]), np.rint(late * 1e9).astype(np.int64), lost))
    return tuple(out)


def motor_delay(spec: dict[str, Any]) -> float:
    """Extra delay inside the motor, in s."""
    return sum(float(e["delay"]) for e in effects_of(spec, "motor", "extra_delay"))
