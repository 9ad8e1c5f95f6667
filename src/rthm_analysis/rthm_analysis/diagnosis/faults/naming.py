"""What a channel is called in a fault: its block, its field of the message, and its name in a sentence."""

from __future__ import annotations

from rthm_analysis.diagnosis.replay.evidence import MOTION, Channel
from rthm_analysis.diagnosis.result import Fault

FIELDS = {family: family for family in MOTION} | {"force": "effort", "motor": "position"}
"""What follows the place in the name of a channel: its field of ``JointState``, or the quantity itself."""

BLOCKS = {
    "position": "sensor.position",
    "velocity": "sensor.velocity",
    "acceleration": "sensor.acceleration",
    "force": "sensor.force",
    "motor": "motor",
    "load": "sensor.force",
}
"""Block in which a fault of a family shows."""

WORDS = {
    "position": "the position of {}",
    "velocity": "the velocity of {}",
    "acceleration": "the acceleration of {}",
    "force": "the force of {}",
    "motor": "the motor position of {}",
    "load": "the known force on {}",
}


def field_of(channel: Channel) -> str:
    """Name of a channel in a message: ``x1.velocity``, ``a1.effort``."""
    return f"{channel.place}.{FIELDS.get(channel.family, 'effort')}"


def in_words(channel: Channel, *, first: bool = False) -> str:
    """Name of a channel in a sentence; `first`: at its beginning."""
    words = WORDS[channel.family].format(channel.place)
    return words[:1].upper() + words[1:] if first else words


def role_of(channel: Channel) -> str:
    """What ``rthm import --unit`` calls a channel: ``velocity:x1``."""
    return f"{channel.family}:{channel.place}"


def fault_of(
    channel: Channel,
    kind: str,
    words: str,
    interval: tuple[float, float] | None = None,
    value: float | None = None,
) -> Fault:
    """A fault of one channel."""
    return Fault(BLOCKS[channel.family], kind, field_of(channel), words, interval, value)
