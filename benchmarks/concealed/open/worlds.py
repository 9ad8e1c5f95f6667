"""Hybrid tests and plants alone, drawn at random, and the rigs as which they are told."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from benchmarks.concealed.draw import draw_test
from benchmarks.concealed.loop import TRUE
from benchmarks.concealed.open.scale import Scale
from benchmarks.concealed.simulate import run
from benchmarks.concealed.world import NO_SINES, HybridTest

NO_WIRE = 1e-12  # N/m: nothing pulls at a plant alone
# Rig: eigenfrequency in Hz, amplitude in m, mass in kg, each a range.
RIGS = {
    "bench": ((1.0, 8.0), (0.005, 0.2), (0.3, 10.0)),
    "resonator": ((200.0, 3000.0), (2e-6, 5e-4), (1e-4, 0.1)),
    "ship": ((0.05, 0.2), (0.2, 3.0), (1e5, 1e8)),
    "machine": ((5.0, 100.0), (5e-5, 5e-3), (50.0, 5000.0)),
}
UNITS = {  # whole-nanosecond scales of hybrid tests: length, time, mass
    "paper": (1.0, 1.0, 1.0),
    "small": (0.02, 0.1, 0.05),
    "large": (5.0, 2.0, 400.0),
    "heavy": (0.1, 0.5, 5000.0),
    "slow": (2.0, 10.0, 2e4),
}


@dataclass
class Setting:
    """A test before anything is concealed in it.

    Parameters
    ----------
    plain
        Whether the plant is alone.
    test
        Its spec is the nominal one.
    pilot
        Shape (n1, 4): x1, v1, u, F without noise; a plant alone has its spring's force as F.
    duration
        Seconds, at the scale of the simulation.
    scale
        To the rig's units.
    rig
        Its name.
    velocity
        Whether the velocity is recorded.
    drive
        Name under which a known load is recorded; empty: with the dof.
    """

    plain: bool
    test: HybridTest
    pilot: np.ndarray
    duration: float
    scale: Scale
    rig: str
    velocity: bool = True
    drive: str = ""

    @property
    def loaded(self) -> bool:
        """Whether a known load acts on the plant."""
        return bool(len(self.test.sines1))


def between(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw evenly on a logarithmic scale, four digits kept."""
    return float(f"{np.exp(rng.uniform(np.log(low), np.log(high))):.4g}")


def draw_loop(rng: np.random.Generator, loaded: bool = False, rig: str = "") -> Setting:
    """Draw a hybrid test of 20 to 40 s (at the scale of the simulation); `loaded`: by a load on the plant."""
    rig = rig or str(rng.choice(list(UNITS), p=(0.5, 0.15, 0.1, 0.15, 0.1)))
    while True:
        test, pilot = draw_test(rng, transmission=False)
        if len(test.sines1) or not loaded:
            break
    return Setting(False, test, pilot, float(rng.integers(20, 41)), Scale(*UNITS[rig]), rig)


def draw_plain(
    rng: np.random.Generator,
    loaded: bool | None = None,
    rig: str = "",
    velocity: bool | None = None,
    per_period: float = 0.0,
    periods: float = 0.0,
) -> Setting:
    """Draw a plant alone: 20 to 2000 samples per period, at most 15 000; None, 0: any."""
    rig = rig or str(rng.choice(list(RIGS)))
    per_period = per_period or between(rng, 20.0, 2000.0)
    if loaded is None:
        loaded = per_period > 100.0 and rng.random() < 0.7
    per_period = max(per_period, 250.0) if loaded else per_period
    periods = periods or float(np.clip(rng.uniform(12.0, 60.0), 7.5, 15000.0 / per_period))
    test = HybridTest(_plain_spec(rng, per_period, periods, loaded))
    w = _frequency(test.spec)
    if loaded:
        test.sines1 = _lines(rng, w, per_period)
        test.ramp1 = round(2.0 * np.pi / w, 3)
    duration = periods * 2.0 * np.pi / w
    pilot = plain_pilot(test, duration)
    _to_size(test, pilot)
    if velocity is None:
        velocity = bool(rng.random() < 0.5)
    drive = "drive" if loaded and rng.random() < 0.5 else ""
    return Setting(
        True, test, plain_pilot(test, duration), duration, _rig(rng, rig, test.spec), rig, velocity, drive
    )


def _frequency(spec: dict[str, Any]) -> float:
    return float(np.sqrt(spec["plant"]["stiffness"][0] / spec["plant"]["mass"][0]))


def _plain_spec(rng: np.random.Generator, per_period: float, periods: float, loaded: bool) -> dict[str, Any]:
    """All that the loop's simulation needs; only `plant` is told."""
    mass, w = between(rng, 0.5, 5.0), between(rng, 1.8, 6.0)
    ratio = rng.uniform(1.0, 4.0) / (2.0 * np.pi * periods)
    ratio = between(rng, 0.003, 0.1) if loaded else ratio
    td1 = round(2.0 * np.pi / w / per_period, 6)
    idle = {"mass": [1.0], "damping": [0.0], "stiffness": [1.0]}
    start = 0.0 if loaded and rng.random() < 0.5 else float(f"{rng.uniform(0.1, 0.3):.3g}")
    return {
        "plant": {
            "dofs": ["x1"],
            "mass": [mass],
            "damping": [float(f"{2.0 * ratio * mass * w:.4g}")],
            "stiffness": [float(f"{mass * w**2:.4g}")],
            "initial_position": [start],
            "initial_velocity": [0.0],
        },
        "numerical": idle,
        "interface": {"stiffness": [0.0], "damping": [0.0]},
        "actuator": {"names": ["a1"], "stiffness": [NO_WIRE]},
        "timing": {"td1": td1, "td2": 1.0, "td3": 1.0, "tau1": 1.0, "tau2": 1.0, "tau3": 1.0, "tau4": 1.0},
    }


def _lines(rng: np.random.Generator, w: float, per_period: float) -> np.ndarray:
    """One tone near resonance, or lines up to 3 times the eigenfrequency, 100 samples per period or more."""
    high = min(3.0, per_period / 100.0) * w
    if rng.random() < 0.2:
        return np.array([[1.0, w * rng.uniform(0.5, 1.5), rng.uniform(0.0, 6.0)]])
    count = int(rng.integers(8, 25))
    edges = np.linspace(0.15 * w, high, count + 1)
    phases = rng.uniform(0.0, 2.0 * np.pi, count)
    return np.stack([np.full(count, np.sqrt(2.0 / count)), rng.uniform(edges[:-1], edges[1:]), phases], 1)


def plain_pilot(test: HybridTest, duration: float) -> np.ndarray:
    """x1, v1, u and the spring's force of the plant alone, without noise."""
    pilot = run(test, duration, 0, noisy=False, step=4e-4).plant[:, TRUE].copy()
    pilot[:, 3] = test.spec["plant"]["stiffness"][0] * pilot[:, 0]
    pilot[:, 2] = 2.0 * pilot[:, 0]
    return pilot


def _to_size(test: HybridTest, pilot: np.ndarray) -> None:
    """Make the motion 0.1 m rms."""
    factor = 0.1 / float(np.sqrt(np.mean(pilot[:, 0] ** 2)))
    test.sines1 = test.sines1 * np.array([factor, 1.0, 1.0]) if len(test.sines1) else NO_SINES
    start = test.spec["plant"]["initial_position"][0]
    test.spec["plant"]["initial_position"] = [float(f"{start * factor:.4g}")]


def _rig(rng: np.random.Generator, rig: str, spec: dict[str, Any]) -> Scale:
    """Scale to a rig, with a sampling period of whole nanoseconds."""
    hertz, metres, kilograms = RIGS[rig]
    td1 = spec["timing"]["td1"]
    time = _frequency(spec) / (2.0 * np.pi) / between(rng, *hertz)
    real = max(round(td1 * time * 1e9), 1)
    mass = between(rng, *kilograms) / spec["plant"]["mass"][0]
    return Scale(between(rng, *metres) / 0.1, real * 1e-9 / td1, mass)


def copied(test: HybridTest) -> HybridTest:
    """Return a test that can be changed."""
    return copy.deepcopy(test)
