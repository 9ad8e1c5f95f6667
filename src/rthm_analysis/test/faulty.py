"""Recordings of the paper's plant, with and without effects, as tests of the faults of recordings need
them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_core.physical.side import PhysicalSide
from rthm_core.spec import Spec, apply, read_spec, shipped_spec

PAPER = shipped_spec("paper")
NOISE = np.array([1e-4, 2e-3, 0.02, 1e-5])
CHANNELS = (
    Channel("position", "x1"),
    Channel("velocity", "x1"),
    Channel("force", "a1"),
    Channel("motor", "a1"),
)
POSITION, VELOCITY, FORCE, MOTOR = range(4)
TD1, TD3 = 1_200_000, 4_000_000
SAMPLES = 10_000

PLAIN = read_spec("""/**:
  ros__parameters:
    plant: {dofs: [x1], mass: [1.2], damping: [0.3], stiffness: [12.0], initial_position: [0.05]}
""")
"""A plant under a known force."""

Tones = tuple[tuple[float, float, float], ...]
TONES: Tones = ((0.10, 2.1, 0.0), (0.06, 5.3, 1.0), (0.03, 11.7, 2.0), (0.015, 23.0, 0.5))
"""Amplitude, rad/s and phase of the commands, m; ten times as much, in N, of loads."""


def having(spec: Spec, block: str, kind: str, **parameters: float) -> Spec:
    place = {"actuator": "a1"} if block in ("wire", "motor", "sensor.force") else {"dof": "x1"}
    one = {"block": block, "kind": kind, **place, **parameters}
    return apply(spec, {"effects": ["one"], "one": one})


def wave(time: np.ndarray, seed: int) -> np.ndarray:
    turn = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, len(TONES))
    return np.asarray(sum(a * np.sin(w * time + p + t) for (a, w, p), t in zip(TONES, turn, strict=True)))


def hybrid(spec: Spec = PAPER, seed: int = 0, noise: float = 1.0, samples: int = SAMPLES) -> Evidence:
    """The paper's physical side under commands of its own."""
    stamps = np.arange(samples) * TD1
    due = np.arange(0, stamps[-1], TD3) + 10_000_000
    commands = 0.5 + wave(due * 1e-9, seed) - wave(due[:1] * 1e-9, seed)
    side, rows, j = PhysicalSide(spec), [], 0
    for stamp in stamps.tolist():
        while j < due.size and due[j] <= stamp:
            side.command(int(due[j]), commands[j : j + 1])
            j += 1
        seen = side.sample(stamp)
        rows.append([seen.position[0], seen.velocity[0], seen.force[0], seen.motor_position[0]])
    scatter = np.random.default_rng(seed).normal(size=(samples, 4)) * NOISE * noise
    load = np.zeros((samples, 1))
    return Evidence(stamps, due, commands[:, None], load, CHANNELS, np.array(rows) + scatter, "command")


def plain(spec: Spec = PLAIN, seed: int = 0, noise: float = 1.0, driven: bool = True) -> Evidence:
    """A plant alone: position and velocity under a known force, or swinging freely."""
    if driven:
        load = {
            "dof": "x1",
            "kind": "multisine",
            "rms": 2.0,
            "low": 1.0,
            "high": 20.0,
            "count": 20,
            "seed": seed,
        }
        spec = apply(spec, {"load.plant": load})
    side, rows = PhysicalSide(spec), []
    stamps = np.arange(SAMPLES) * TD1
    for stamp in stamps.tolist():
        seen = side.sample(stamp)
        rows.append([seen.position[0], seen.velocity[0], seen.load[0]])
    values = np.array(rows)
    scatter = np.random.default_rng(seed).normal(size=(SAMPLES, 2)) * NOISE[:2] * noise
    nothing = np.empty(0, dtype=np.int64), np.empty((0, 0))
    return Evidence(stamps, *nothing, values[:, 2:], CHANNELS[:2], values[:, :2] + scatter, "force")


def changed(evidence: Evidence, column: int, change: Callable[[np.ndarray], np.ndarray]) -> Evidence:
    measured = evidence.measured.copy()
    measured[:, column] = change(measured[:, column].copy())
    return replace(evidence, measured=measured)


def later(evidence: Evidence, column: int, delay: float) -> Evidence:
    """The same with one channel that comes later by whole samples, as if the test had begun before."""
    by = round(delay / (TD1 * 1e-9))
    columns = [evidence.measured[abs(by) : -abs(by), i] for i in range(evidence.measured.shape[1])]
    columns[column] = evidence.measured[abs(by) - by : -abs(by) - by or None, column]
    part = slice(abs(by), -abs(by))
    return replace(
        evidence,
        stamps_ns=evidence.stamps_ns[part],
        load=evidence.load[part],
        measured=np.stack(columns, axis=1),
    )
