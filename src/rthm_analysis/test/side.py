"""The paper's physical side under commands of its own, as tests of the diagnosis see it."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_core.physical.side import PhysicalSide
from rthm_core.spec import Spec, apply, shipped_spec

PAPER = shipped_spec("paper")
STAMPS = np.arange(1700) * 1_200_000
DUE = np.arange(0, 480) * 4_000_000 + 10_000_000
COMMANDS = (0.5 + 0.3 * np.sin(3e-9 * DUE)).reshape(-1, 1)
CHANNELS = (
    Channel("position", "x1"),
    Channel("velocity", "x1"),
    Channel("force", "a1"),
    Channel("motor", "a1"),
)
EVIDENCE = Evidence(
    STAMPS, DUE, COMMANDS, np.zeros((STAMPS.size, 1)), CHANNELS, np.zeros((STAMPS.size, 4)), "command"
)


def having(block: str, kind: str, poles: bool = False, **parameters: float) -> Spec:
    spec = apply(PAPER, {"actuator.motor_poles": [400.0, 2000.0]}) if poles else PAPER
    place = {"dof": "x1"} if block in ("plant", "sensor.position", "sensor.velocity") else {"actuator": "a1"}
    return apply(spec, {"effects": ["one"], "one": {"block": block, "kind": kind, **place, **parameters}})


def simulated(
    spec: Spec, commands: np.ndarray = COMMANDS, due: np.ndarray = DUE, stamps: np.ndarray = STAMPS
) -> np.ndarray:
    """Position, velocity, force and motor position as the simulator's own data acquisition sees them."""
    side, rows, j = PhysicalSide(spec), [], 0
    for stamp in stamps.tolist():
        while j < due.size and due[j] <= stamp:
            side.command(int(due[j]), commands[j])
            j += 1
        seen = side.sample(stamp)
        rows.append([seen.position[0], seen.velocity[0], seen.force[0], seen.motor_position[0]])
    return np.array(rows)
