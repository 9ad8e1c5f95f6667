"""A recording that ends at rest is judged by the end of its motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.replay.evidence import Evidence

from .plain import NOISE, recorded


def _stopping(until: float, duration: float = 40.0) -> Evidence:
    """A free decay that dry friction ends at an instant, s."""
    seen = recorded(duration=duration, force=0.0)
    fades = np.maximum(1.0 - seen.time / until, 0.0)
    motion = 0.4 * fades[:, None] * np.column_stack([np.cos(3.0 * seen.time), -3.0 * np.sin(3.0 * seen.time)])
    noise = np.random.default_rng(1).normal(size=motion.shape) * np.array(NOISE)
    return replace(seen, measured=motion + noise)


def test_what_follows_a_motion_is_left_out_and_said() -> None:
    seen = _stopping(until=8.0)
    moving = seen.until_rest()
    assert seen.comes_to_rest and not moving.comes_to_rest
    assert 6.0 < moving.time[moving.trained] < 8.0 < moving.time[-1]
    assert any("Nothing moves after" in one for one in moving.notes)


def test_a_motion_that_goes_on_is_used_whole() -> None:
    seen = _stopping(until=36.0)
    assert seen.until_rest() is seen


def test_what_hardly_moved_is_used_whole() -> None:
    seen = _stopping(until=0.5)
    assert seen.comes_to_rest and seen.until_rest() is seen
