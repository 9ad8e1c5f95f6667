"""The loop, or the plant alone, with how far each block's prediction is from the recording."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from rthm_analysis.diagnosis.result import Diagnosis, Mismatch
from rthm_analysis.report.loop_drawing import Mark, draw_loop, draw_plant
from rthm_analysis.timing import timing_of
from rthm_core.errors import InputError

if TYPE_CHECKING:
    from rthm_analysis.recording import Recording
    from rthm_core.spec import Spec

DRAWN_AS = {
    "wire": "motor",
    "sensor.position": "sampling",
    "sensor.velocity": "sampling",
    "sensor.acceleration": "sampling",
    "sensor.force": "sampling",
}
"""Blocks that share a box of the drawing with another."""

FAR = 1e3
"""Mismatch from which its digits say nothing more."""


def drawing(diagnosis: Diagnosis, recording: Recording, spec: Spec) -> str:
    """SVG with the located blocks framed; empty where the loop cannot be drawn."""
    marks = _marks(diagnosis)
    if not spec.is_loop:
        return draw_plant(spec, marks)
    with suppress(InputError):
        return draw_loop(spec, timing_of(recording, spec), marks)
    return ""


def _marks(diagnosis: Diagnosis) -> dict[str, Mark]:
    """For each box of the drawing, words on the blocks in it."""
    inside: dict[str, list[Mismatch]] = {}
    for one in diagnosis.blocks:
        inside.setdefault(DRAWN_AS.get(one.block, one.block.removeprefix("link.")), []).append(one)
    return {box: _mark(blocks, diagnosis.located) for box, blocks in inside.items()}


def _mark(blocks: list[Mismatch], located: tuple[str, ...]) -> Mark:
    """What to say of a box: its located blocks by name, else its largest mismatch."""
    named = [one for one in blocks if one.block in located]
    if named:
        return Mark(", ".join(f"{one.block}: {times_noise(one.mismatch)}" for one in named), True)
    return Mark(times_noise(max(one.mismatch for one in blocks)), False)


def times_noise(mismatch: float) -> str:
    """Mismatch in words; an exact replay leaves less than any noise."""
    if mismatch < 0.01:
        return "exact"
    return f"{mismatch:.3g} x noise" if mismatch < FAR else f"{mismatch:.1e} x noise"
