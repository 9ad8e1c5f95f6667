"""How finely a replay has to go through time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.replay import (
    AFFORDED_STEPS,
    DRAFT_GRID_RADIANS,
    DRAFT_STEP_RADIANS,
    GATHERED_ERROR_SHARE,
    KINK_STEP_RADIANS,
    KINK_STEP_S,
    LONGEST_GRID_INTERVAL_NS,
    LONGEST_STEP_RADIANS,
    MOST_SUBSTEPS,
    SHARP_GRID_RADIANS,
    SHORTEST_STEP_RADIANS,
    STEP_ERROR_DIVISOR,
    TURN_GRID_RADIANS,
)
from rthm_analysis.diagnosis.replay.mechanics import Mechanics, modes
from rthm_analysis.diagnosis.replay.motor import drive_speed
from rthm_core.clock import NS
from rthm_core.effects.laws import has_inertia

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec import Spec


def longest_interval(spec: Spec, of_motion: int, *, sharp: bool, coarse: bool) -> int:
    """Longest interval of the grid in ns: `of_motion` where that is longer and nothing is faster in itself;
    shorter where it is `sharp` and a wire remembers its path.
    """
    longest = shortest = LONGEST_GRID_INTERVAL_NS
    if _remembers(spec):
        angle, shortest = SHARP_GRID_RADIANS if sharp else TURN_GRID_RADIANS, 0
    elif _moves(spec):
        angle, shortest = DRAFT_GRID_RADIANS if coarse else TURN_GRID_RADIANS, 0
    elif of_motion <= longest or _changes(spec):
        return longest
    else:
        angle, longest = TURN_GRID_RADIANS, of_motion
    fastest_motor = drive_speed(spec)
    return max(shortest, min(longest, int(angle / fastest_motor * NS))) if fastest_motor else longest


def can_be_sharper(spec: Spec) -> bool:
    """Whether a sharp grid is a finer one: where a wire remembers the path of a motor that takes its time."""
    return _remembers(spec) and drive_speed(spec) > 0.0


def worth(spec: Spec) -> int:
    """Work of a step, in those of most models."""
    return max((e.law.cost for e in spec.effects), default=1)


def steps_in(time: Floats, spec: Spec, mechanics: Mechanics, over: float, *, coarse: bool) -> Integers:
    """Steps (g,) within each interval of a grid `time` (g,), in s, for free runs of `over` s.

    A motion that lasts for many radians gathers the errors of its steps, and so needs shorter ones, as far as
    so many intervals can afford them.
    """
    eigenvalues = modes(mechanics, spec)
    rates = np.abs(eigenvalues)
    radians = rates / np.maximum(-eigenvalues.real, 1.0 / over)
    phases = np.clip(
        (GATHERED_ERROR_SHARE * STEP_ERROR_DIVISOR / np.maximum(radians, 1.0)) ** 0.25,
        SHORTEST_STEP_RADIANS,
        LONGEST_STEP_RADIANS,
    )
    intervals = np.diff(time, append=time[-1])
    longest = float(intervals.max())
    kink_rate = 1.0 / _longest_step(spec, float(rates.max(initial=0.0)))
    most, needed = (
        1.0 / max(float(rate.max(initial=0.0)), kink_rate, 1e-9)
        for rate in (rates / (DRAFT_STEP_RADIANS if coarse else LONGEST_STEP_RADIANS), rates / phases)
    )
    afforded = longest / max(1, AFFORDED_STEPS // time.size)
    step = max(needed, min(most, afforded), longest / MOST_SUBSTEPS)
    return np.maximum(1, np.ceil(intervals / step - 1e-6)).astype(np.int64)


def _longest_step(spec: Spec, fastest: float) -> float:
    """Longest step in s: short beside the `fastest` motion, rad/s, where a law has kinks."""
    if _remembers(spec):
        return KINK_STEP_S
    kinks = any(e.law.kinked for e in spec.effects)
    return max(KINK_STEP_S, KINK_STEP_RADIANS / max(fastest, 1e-9)) if kinks else np.inf


def _remembers(spec: Spec) -> bool:
    """Whether a wire has kinks: its force depends on where the motor has been."""
    pretension = spec.actuator is not None and any(spec.actuator.pretension)
    return pretension or any(e.block == "wire" and e.law.kinked for e in spec.effects)


def _moves(spec: Spec) -> bool:
    """Whether a wire has a motion of its own between motor and plant."""
    transmission = spec.actuator.transmission if spec.actuator else None
    pulley = transmission is not None and transmission.moves
    return pulley or any(e.block == "wire" and e.law.states for e in spec.effects)


def _changes(spec: Spec) -> bool:
    """Whether a law changes with time by itself, as a tone does; steps end where a mass changes."""
    return any("t" in e.law.depends_on and not has_inertia(e.law) for e in spec.effects)
