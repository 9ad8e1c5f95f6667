"""Where an effect may sit (contract, section 6)."""

from __future__ import annotations

from rthm_core.errors import RefusedError, suggestion
from rthm_core.topics import LINKS

SENSORS = {"position": "m", "velocity": "m/s", "acceleration": "m/s^2", "force": "N"}
BLOCKS = (
    "plant",
    "wire",
    "motor",
    "numerical",
    "controller",
    *(f"link.{name}" for name in LINKS),
    *(f"sensor.{name}" for name in SENSORS),
)

PLACES = {
    "plant": "dof",
    "wire": "actuator",
    "motor": "actuator",
    "sensor.position": "dof",
    "sensor.velocity": "dof",
    "sensor.acceleration": "dof",
    "sensor.force": "actuator",
}
"""Which key of the spec names the place within a block; blocks that are one thing have none."""


def family(block: str) -> str:
    """Family of a block: ``link`` of ``link.tau1``."""
    return block.partition(".")[0]


def check_block(block: object) -> str:
    """Return a block's name; raise RefusedError if there is none of this name."""
    if block not in BLOCKS:
        raise RefusedError(block, f"one of {', '.join(BLOCKS)}", suggestion(str(block), BLOCKS))
    return str(block)
