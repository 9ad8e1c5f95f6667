"""A plant with two dofs, driven by known loads or by two motors, integrated in small steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from benchmarks.two_dofs.laws import Law, Scale

STEP, SUBSTEPS, COMMAND_EVERY, TAU4 = 0.002, 8, 2, 0.004
NOISE = {"position": 1e-4, "velocity": 2e-3, "motor": 1e-5, "force": 0.02}
PLACES = {"x1": (1.0, 0.0), "x2": (0.0, 1.0), "between": (1.0, -1.0)}


@dataclass(frozen=True)
class Rig:
    """Matrices of the plant, its wires (none for a plant alone), and the tones that drive it."""

    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    wires: np.ndarray
    tones: np.ndarray
    duration: float

    @property
    def has_motors(self) -> bool:
        """Whether it hangs on motors."""
        return bool(self.wires.any())

    def drive(self, time: np.ndarray) -> np.ndarray:
        """Loads, N, or commands, m: (s, 2)."""
        size, omega, phase = np.moveaxis(self.tones, -1, 0)
        rows = zip(size, omega, phase, strict=True)
        return np.stack([np.sin(np.outer(time, w) + p) @ a for a, w, p in rows], axis=1)


@dataclass(frozen=True)
class Run:
    """Samples: positions, velocities (s, 2), motors and wire forces (s, 2); the drive at its own instants."""

    x: np.ndarray
    v: np.ndarray
    motor: np.ndarray
    force: np.ndarray
    drive: np.ndarray


def draw_rig(rng: np.random.Generator, *, motors: bool) -> Rig:
    """Draw a rig of 20 s with eigenfrequencies of some rad/s."""
    mass = np.diag(rng.uniform(0.6, 2.0, 2))
    own, joint = rng.uniform(8.0, 30.0, 2), float(rng.uniform(5.0, 15.0))
    stiffness = np.diag(own + joint) - joint * np.array([[0.0, 1.0], [1.0, 0.0]])
    damping = 0.02 * stiffness + np.diag(rng.uniform(0.05, 0.2, 2))
    wires = rng.uniform(20.0, 40.0, 2) if motors else np.zeros(2)
    count = 8
    size = rng.uniform(0.5, 1.5, (2, count)) * (0.05 if motors else 0.7) / np.sqrt(count)
    omega, phase = rng.uniform(0.6, 9.0, (2, count)), rng.uniform(0.0, 2.0 * np.pi, (2, count))
    tones = np.stack([size, omega, phase], axis=-1)
    return Rig(mass, damping, stiffness, wires, tones, 20.0)


def simulate(rig: Rig, law: Law | None = None, place: str = "x1") -> Run:
    """Integrate by Runge and Kutta's method of fourth order, in plain numbers."""
    count, h = round(rig.duration / STEP) + 1, STEP / SUBSTEPS
    at = rig.drive(np.arange(count) * STEP)
    held = np.repeat(at[::COMMAND_EVERY], COMMAND_EVERY, axis=0)[:count]
    late = round(TAU4 / STEP)
    motor = np.vstack([np.zeros((late, 2)), held[: count - late]]) * rig.has_motors
    fine = rig.drive(np.arange(2 * SUBSTEPS * (count - 1) + 1) * 0.5 * h).tolist()
    pushes = (rig.wires * motor).tolist()
    rate = _rate(rig, law, place)
    y, rows = [0.0] * 5, np.empty((count, 5))
    for i in range(count):
        rows[i] = y
        for j in range(SUBSTEPS if i + 1 < count else 0):
            k = 2 * (i * SUBSTEPS + j)
            first, middle, last = [pushes[i]] * 3 if rig.has_motors else fine[k : k + 3]
            a = rate(y, first)
            b = rate([p + 0.5 * h * q for p, q in zip(y, a, strict=True)], middle)
            c = rate([p + 0.5 * h * q for p, q in zip(y, b, strict=True)], middle)
            d = rate([p + h * q for p, q in zip(y, c, strict=True)], last)
            stages = zip(y, a, b, c, d, strict=True)
            y = [p + h / 6.0 * (q + 2.0 * r + 2.0 * s + t) for p, q, r, s, t in stages]
    x, v = rows[:, :2], rows[:, 2:4]
    return Run(x, v, motor, rig.wires * (motor - x), at)


def _rate(rig: Rig, law: Law | None, place: str) -> Callable[[list[float], list[float]], list[float]]:
    """Rate of [x1, x2, v1, v2, own state of the law] under a known push on both dofs."""
    (m1, _), (_, m2) = rig.mass.tolist()
    (c11, c12), (c21, c22) = rig.damping.tolist()
    (k11, k12), (k21, k22) = (rig.stiffness + np.diag(rig.wires)).tolist()
    r1, r2 = PLACES[place]

    def rate(y: list[float], known: list[float]) -> list[float]:
        x1, x2, v1, v2, z = y
        force, own = (0.0, 0.0) if law is None else law.force(r1 * x1 + r2 * x2, r1 * v1 + r2 * v2, z)
        push1 = known[0] - c11 * v1 - c12 * v2 - k11 * x1 - k12 * x2 + r1 * force
        push2 = known[1] - c21 * v1 - c22 * v2 - k21 * x1 - k22 * x2 + r2 * force
        return [v1, v2, push1 / m1, push2 / m2, own]

    return rate


def scale_at(rig: Rig, run: Run, place: str) -> Scale:
    """How large things are at a place."""
    reach = np.array(PLACES[place])
    x, v = run.x @ reach, run.v @ reach
    force = (run.x @ rig.stiffness) @ reach / (reach @ reach)
    return Scale(float(x.std()), float(v.std()), float(np.abs(x).max()), float(force.std()))


def visibility(one: Run, other: Run, *, motors: bool) -> float:
    """Largest rms difference of two runs in a channel, over its noise."""
    apart = [np.abs(one.x - other.x) / NOISE["position"], np.abs(one.v - other.v) / NOISE["velocity"]]
    apart += [np.abs(one.force - other.force) / NOISE["force"]] if motors else []
    return float(np.sqrt(np.mean(np.square(np.hstack(apart)), axis=0)).max())


def spec_of(rig: Rig) -> dict[str, Any]:
    """The nominal spec, which knows nothing of any effect."""
    matrices = {"mass": rig.mass, "damping": rig.damping, "stiffness": rig.stiffness}
    plant = {"dofs": ["x1", "x2"], "initial_position": [0.0, 0.0], "initial_velocity": [0.0, 0.0]}
    plant |= {name: [float(one) for one in matrix.ravel()] for name, matrix in matrices.items()}
    if not rig.has_motors:
        return {"plant": plant}
    side = {"dofs": ["y1", "y2"], "mass": [1.0, 0.0, 0.0, 1.0], "damping": [0.1, 0.0, 0.0, 0.1]}
    side |= {
        "stiffness": [5.0, 0.0, 0.0, 5.0],
        "initial_position": [0.0, 0.0],
        "initial_velocity": [0.0, 0.0],
    }
    return {
        "plant": plant,
        "numerical": side,
        "interface": {
            "plant_dof": ["x1", "x2"], "numerical_dof": ["y1", "y2"], "stiffness": [5.0, 5.0],
            "damping": [0.1, 0.1],
        },
        "actuator": {"names": ["a1", "a2"], "stiffness": [float(one) for one in rig.wires]},
        "timing": {
            "td1": STEP, "td2": 0.008, "td3": COMMAND_EVERY * STEP, "td4": 0.0, "tau1": 0.0, "tau2": 0.0,
            "tau3": 0.0, "tau4": TAU4,
        },
    }  # fmt: skip
