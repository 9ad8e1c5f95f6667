"""How far an effect moves the recorded channels, in units of what is unknown about them.

Effects in the plant, the wire and the motor are taken away and the plant is driven by the same commands once
more: the difference of x1, v1, u, F (rms) over the noise of that channel. Sensors: what they add to the
truth, over their noise. Links: share of the samples that were used at another instant, or in place of
another, over one per cent. Blocks that compute: relative error of what they compute, over 1e-3.
"""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
from benchmarks.concealed.loop import SEEN, TRUE, Recording
from benchmarks.concealed.simulate import replay, run
from benchmarks.concealed.world import (
    CHANNELS,
    REFERENCE_NOISE,
    HybridTest,
    controller_stiffness,
    motor_delay,
    ns,
    wire_stiffness,
)

NOISE = np.array([REFERENCE_NOISE[c] for c in CHANNELS])
FLOOR = 1.0  # an effect below is no fair case


def rms(values: np.ndarray) -> np.ndarray:
    """Root mean square of every column."""
    return np.sqrt(np.mean(np.square(values), axis=0))


def without(test: HybridTest, name: str) -> HybridTest:
    """Return the same test without one effect."""
    spec: dict[str, Any] = copy.deepcopy(test.spec)
    spec["effects"].remove(name)
    return HybridTest(spec, test.sines1, test.ramp1, test.sines2, test.ramp2)


def visibility(test: HybridTest, name: str, log: Recording) -> float:
    """Visibility of one effect of the test that `log` recorded."""
    block, less = test.spec[name]["block"], without(test, name)
    if block in ("plant", "wire", "motor"):
        return replayed(less, log, motor_delay(test.spec) - motor_delay(less.spec))
    if block.startswith("sensor"):
        return _sensed(block, log)
    if block.startswith("link"):
        return _linked(test, name, log)
    return _computed(test, less, log, block)


def replayed(other: HybridTest, log: Recording, earlier: float = 0.0) -> float:
    """Largest rms difference of x1, v1, u, F from another plant under the same commands, over the noise."""
    return float((rms(replay(other, log, earlier) - log.plant[:, TRUE]) / NOISE).max())


def _sensed(block: str, log: Recording) -> float:
    i = CHANNELS.index(block.split(".")[1])
    square = np.mean(np.square(log.plant[:, SEEN] - log.plant[:, TRUE]), axis=0)[i] - NOISE[i] ** 2
    return float(np.sqrt(max(square, 0.0)) / NOISE[i])


def _linked(test: HybridTest, name: str, log: Recording) -> float:
    if test.spec[name]["kind"] == "clock_offset":
        return float(test.spec[name]["offset"]) / test.spec["timing"]["td1"]
    i = int(test.spec[name]["block"][-1])
    use, stamp = log.use[i - 1, : log.count[1 + i]].T
    tau, td1 = ns(test.spec["timing"][f"tau{i}"]), ns(test.spec["timing"]["td1"])
    if i < 3:
        changed = np.mean(stamp != (use - tau) // td1 * td1)
    else:
        sent = log.count[0] if i == 3 else log.count[1]
        changed = 1.0 - np.sum(use == stamp + tau) / sent
    return float(changed / 0.01)


def _computed(test: HybridTest, less: HybridTest, log: Recording, block: str) -> float:
    if block == "controller":
        wrong = log.command[:, 1] * (
            1.0 / controller_stiffness(test.spec) - 1.0 / wire_stiffness(test.spec["actuator"])
        )
        return float(rms(wrong) / (1e-3 * rms(log.command[:, 0])))
    duration = log.plant.shape[0] * test.spec["timing"]["td1"]
    F_d, right = (run(t, duration, 0, noisy=False).numerical[:, 3] for t in (test, less))
    return float(rms(F_d - right) / (1e-3 * rms(right)))
