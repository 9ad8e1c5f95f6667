"""Where free runs begin: once at the start of the test, or again and again where they would drift away."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.replay import (
    DRIFT_DECAY_EXPONENT,
    SHORT_WINDOW_PERIODS,
    SHORTEST_WINDOW_PERIODS,
    START_FEWEST_SAMPLES,
    START_HALF_WIDTH,
    START_PERIOD_SHARE,
    WINDOW_FEWEST_SAMPLES,
)
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.mechanics import mechanics, state_matrix
from rthm_analysis.diagnosis.replay.starting import refined

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec import Spec


@dataclass(frozen=True)
class Windows:
    """Free runs of one recording, or of several.

    Attributes
    ----------
    start : (r,) array
        First sample of each.
    state : (r, 2 n) array
        Positions and velocities there.
    length : float or None
        Seconds of each; None: one run over the whole of every recording.
    """

    start: Integers
    state: Floats
    length: float | None

    def of(self, samples: int) -> Integers:
        """Which window each of the samples is in."""
        return np.asarray(np.searchsorted(self.start, np.arange(samples), side="right") - 1)

    def first(self, samples: int) -> Windows:
        """Those that begin within the first samples."""
        kept = self.start < samples
        return Windows(self.start[kept], self.state[kept], self.length)

    def every(self, step: int, samples: int) -> tuple[Integers, Windows]:
        """The first of `step` samples each of every window, of so many samples in all; windows of these."""
        ends = np.append(self.start[1:], samples)
        kept = [np.arange(a, b, step) for a, b in zip(self.start, ends, strict=True)]
        start = np.cumsum([0, *(part.size for part in kept[:-1])])
        return np.concatenate(kept), Windows(start, self.state, self.length)

    @property
    def is_one(self) -> bool:
        """Whether there is just one run."""
        return self.length is None and self.start.size == 1

    def moved(self, column: int, by: float) -> Windows:
        """The same with one entry of every state moved."""
        state = self.state.copy()
        state[:, column] += by
        return self.at(state)

    def at(self, state: Floats) -> Windows:
        """The same from other states."""
        return Windows(self.start, state, self.length)


def windows(
    evidence: Evidence, spec: Spec, known_start: bool, longer: float = 1.0, short: bool = False
) -> Windows:
    """Free runs for a spec: windows where it drifts or is unstable, or where short ones are asked for.

    Parameters
    ----------
    evidence : Evidence
    spec : Spec
    known_start : bool
        Whether the test began at rest in the spec's initial state; else the state is estimated.
    longer : float
        Length of windows over the shortest.
    short : bool
        Windows of one period of the motion, in which a wrong model stays near where it would not for long.
    """
    assert spec.plant is not None
    duration = evidence.longest
    length = None
    if short:
        length = longer * SHORT_WINDOW_PERIODS * evidence.period
    elif _drifts(spec, duration):
        length = min(longer * _shortest(evidence, duration), duration)
    instants = [np.arange(a, b, length) if length else np.full(1, a) for a, b in evidence.spans]
    start = np.searchsorted(evidence.time, np.concatenate(instants))
    state = np.array([state_at(evidence, spec, int(s)) for s in start])
    if known_start:
        state[np.isin(start, evidence.begins if evidence.has_several else evidence.begins[:1])] = [
            *spec.plant.initial_position,
            *spec.plant.initial_velocity,
        ]
    runs = Windows(start.astype(np.int64), state, length)
    of_motion = evidence.period
    if known_start or evidence.driven_by != "force" or not of_motion > 0.0:
        return runs
    return refined(evidence, spec, runs, of_motion)


def _drifts(spec: Spec, duration: float) -> bool:
    modes = np.linalg.eigvals(state_matrix(mechanics(spec)))
    return bool(
        np.any(np.abs(modes) * duration < DRIFT_DECAY_EXPONENT)
        or np.any(modes.real * duration > DRIFT_DECAY_EXPONENT)
    )


def _shortest(evidence: Evidence, duration: float) -> float:
    shortest = WINDOW_FEWEST_SAMPLES * float(evidence.time[-1]) / evidence.time.size
    return float(min(max(SHORTEST_WINDOW_PERIODS * evidence.period, shortest), duration))


def _step(evidence: Evidence) -> float:
    return float(evidence.time[-1]) / max(evidence.time.size - 1, 1)


def state_at(evidence: Evidence, spec: Spec, sample: int) -> Floats:
    """Position and velocity at a sample, from parabolas through its neighbours in the same recording."""
    assert spec.plant is not None
    dofs = spec.plant.dofs
    width = min(START_HALF_WIDTH, max(2, int(START_PERIOD_SHARE * evidence.period / _step(evidence))))
    here = next(one for one in reversed(evidence.recordings) if one.start <= sample)
    high = min(max(sample + width + 1, here.start + START_FEWEST_SAMPLES), here.stop)
    low = max(min(sample - width, high - START_FEWEST_SAMPLES), here.start)
    t = evidence.time[low:high] - evidence.time[sample]
    state = np.zeros(2 * len(dofs))
    for column, channel in enumerate(evidence.channels):
        if channel.place not in dofs or channel.family not in ("position", "velocity"):
            continue
        values = evidence.measured[low:high, column]
        known = np.isfinite(values)
        if known.sum() < START_FEWEST_SAMPLES:
            continue
        curve = np.polynomial.polynomial.polyfit(t[known], values[known], 2)
        i = dofs.index(channel.place)
        if channel.family == "position":
            state[i] = curve[0]
            if not any(c.family == "velocity" and c.place == channel.place for c in evidence.channels):
                state[len(dofs) + i] = curve[1]
        else:
            state[len(dofs) + i] = curve[0]
    return state
