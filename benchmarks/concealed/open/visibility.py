"""How far above the noise something is that is concealed, where it shows most.

The recording is cut into tenths. In each, the rms of what the concealed thing does to a channel is taken over
the noise of that channel, and the largest of all is the visibility. What a force on the plant does is what is
left of it after the best multiples of acceleration, velocity, position, known load and a constant have been
taken off - another mass, damping, stiffness, gain and offset -, sent through the linear plant.
"""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
from benchmarks.concealed import visibility as first
from benchmarks.concealed.loop import EXTRA_PLANT, SEEN, TRUE, W1, Recording
from benchmarks.concealed.open.draft import Draft
from benchmarks.concealed.simulate import replay, run
from benchmarks.concealed.world import HybridTest, ns, wire_stiffness

PARTS = 10
FLOORS = {"force": 1.0, "effects": 1.0, "plant": 1.5, "edit": 3.0, "links": 1.0}


def loudest(difference: np.ndarray, noise: np.ndarray) -> float:
    """Return the largest rms of any column in any tenth, over the noise of the column."""
    parts = np.array_split(difference / noise, PARTS)
    return float(max(np.sqrt(np.mean(p**2, axis=0)).max() for p in parts))


def unabsorbed(force: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Return the force less its best approximation by columns (n, k)."""
    scaled = columns / np.maximum(np.abs(columns).max(axis=0), 1e-300)
    return force - scaled @ np.linalg.lstsq(scaled, force, rcond=None)[0]


def response(mass: float, damping: float, stiffness: float, period: float, force: np.ndarray) -> np.ndarray:
    """Return x, v (n, 2) of a linear plant from rest under a force that is straight between its samples."""
    A = np.array([[0.0, 1.0], [-stiffness / mass, -damping / mass]])
    values, vectors = np.linalg.eig(A.astype(complex) + np.diag([1e-12, -1e-12]))
    inverse = np.linalg.inv(vectors)
    move = np.exp(values * period)
    push = (move - 1.0) / values * (inverse @ np.array([0.0, 1.0 / mass]))
    held = 0.5 * (force[1:] + force[:-1])
    modes = np.zeros((len(force), 2), dtype=complex)
    for i, f in enumerate(held):
        modes[i + 1] = move * modes[i] + push * f
    return np.real(modes @ vectors.T)


def force_visibility(draft: Draft, log: Recording) -> float:
    """Visibility of all that acts on the plant beyond the linear model."""
    x, v, _, _ = log.plant[:, TRUE].T
    a = np.gradient(v, draft.period)
    columns = [a, v, x, np.ones_like(x)] + ([log.plant[:, W1]] if draft.setting.loaded else [])
    left = unabsorbed(log.plant[:, EXTRA_PLANT], np.stack(columns, axis=1))
    plant = draft.spec["plant"]
    k_tot = wire_stiffness(draft.spec["actuator"])
    moved = response(plant["mass"][0], plant["damping"][0], plant["stiffness"][0] + k_tot, draft.period, left)
    shown = [0, 1] if draft.setting.velocity else [0]
    seen = loudest(moved[:, shown], draft.noise_size[shown])
    return seen if draft.setting.plain else max(seen, loudest(k_tot * moved[:, :1], draft.noise_size[3:]))


def told_plant_visibility(draft: Draft, log: Recording) -> float:
    """Visibility of the difference between the true plant and the told one, under the same inputs."""
    other = HybridTest(_merged(draft.spec, draft.told), draft.setting.test.sines1, draft.setting.test.ramp1)
    other.start = draft.true.start
    if draft.setting.plain:
        moved = run(other, draft.setting.duration, 0, noisy=False, step=4e-4).plant[:, TRUE]
        shown = [0, 1] if draft.setting.velocity else [0]
    else:
        moved, shown = replay(other, log), [0, 1, 2, 3]
    return loudest((moved - log.plant[:, TRUE])[:, shown], draft.noise_size[shown])


def _merged(true: dict[str, Any], told: dict[str, Any]) -> dict[str, Any]:
    """Return the told spec, with all that only a simulation needs."""
    return (
        copy.deepcopy(true)
        | copy.deepcopy({k: v for k, v in told.items() if k != "timing"})
        | {
            "timing": true["timing"],
            "effects": [],
        }
    )


def visibility(draft: Draft, log: Recording, before: np.ndarray) -> float:
    """Return the visibility; `before` are the samples (n1, 4) ahead of the edits."""
    if draft.measure == "force":
        return force_visibility(draft, log)
    if draft.measure == "effects":
        return min(first.visibility(draft.true, name, log) for name in draft.spec["effects"])
    if draft.measure == "each":
        return min(_one_of_several(draft, log, name) for name in draft.spec["effects"])
    if draft.measure == "plant":
        return told_plant_visibility(draft, log)
    if draft.measure == "edit":
        changed = np.nan_to_num(log.plant[:, SEEN], nan=1e9) - before
        return loudest(changed, np.maximum(draft.noise_size, 1e-12))
    if draft.measure == "links":
        return _late(draft, log)
    return np.inf


def _one_of_several(draft: Draft, log: Recording, name: str) -> float:
    """Visibility of one effect of several: the motion without it, under the same inputs."""
    less = first.without(draft.true, name)
    less.start = draft.true.start
    earlier = first.motor_delay(draft.spec) - first.motor_delay(less.spec)
    shown = [0, 1][: 1 + draft.setting.velocity] if draft.setting.plain else [0, 1, 2, 3]
    moved = replay(less, log, earlier) - log.plant[:, TRUE]
    return loudest(moved[:, shown], draft.noise_size[shown])


def _late(draft: Draft, log: Recording) -> float:
    """Visibility of a delay that is not the told one: in the motion (tau4), in the stamps (others)."""
    worst = 0.0
    for i in range(1, 5):
        more = draft.spec["timing"][f"tau{i}"] - draft.told["timing"][f"tau{i}"]
        if i == 4:
            moved = replay(draft.true, log, more)
            worst = max(worst, loudest(moved - log.plant[:, TRUE], draft.noise_size))
        else:
            worst = max(worst, abs(ns(more)) / 5e5)
    return worst


def enough(draft: Draft, log: Recording, before: np.ndarray) -> tuple[bool, float]:
    """Return whether an ideal observer would see it, and the visibility."""
    if not draft.hidden or draft.measure == "certain":
        return True, np.inf
    seen = visibility(draft, log, before)
    return seen >= FLOORS.get(draft.measure, 1.0), seen
