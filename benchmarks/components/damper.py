"""A magnetorheological damper on a test bench: hysteresis and viscous damping, both gated by a voltage that
lags, beside a spring; with sensors that are noisy.

The equations are written for this benchmark: a normalised Bouc-Wen element ``dz/dx`` in steps of the path,
and the current behind the voltage in closed form.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

Floats = np.ndarray
INNER = 12
"""Steps of the path between two samples."""


@dataclass(frozen=True)
class Damper:
    """One damper and the truth about it.

    Attributes
    ----------
    inputs : tuple of str
        What its force depends on.
    noise : float
        Standard deviation of the force's noise, N.
    share : float
        Part of the force's variance that spring and damper alone, unscaled, do not explain.
    """

    t: Floats
    x: Floats
    force: Floats
    voltage: Floats
    inputs: tuple[str, ...]
    noise: float
    share: float
    truth: dict[str, float]


def draw(seed: int) -> Damper:
    """A damper, its test and its sensors; in one of five the voltage does nothing."""
    rng = np.random.default_rng(seed)
    rate = float(rng.choice([200.0, 500.0, 1000.0]))
    t = np.arange(0.0, rng.uniform(20.0, 40.0), 1.0 / rate)
    stroke = 10.0 ** rng.uniform(-2.5, -1.5)
    x = _motion(rng, t, stroke)
    gated = bool(rng.random() < 0.8)
    voltage, current, lag = _voltage(rng, t, rate)
    force, truth = _force(rng, t, x, current if gated else np.zeros_like(t), stroke)
    noise = float(np.std(force) * 10.0 ** rng.uniform(-2.7, -1.7))
    plain = np.stack([np.ones_like(t), x, np.gradient(x, t)], axis=1)
    left = force - plain @ np.linalg.lstsq(plain, force, rcond=None)[0]
    return Damper(
        t,
        x + stroke * 10.0 ** rng.uniform(-4.0, -3.0) * rng.standard_normal(t.size),
        force + noise * rng.standard_normal(t.size),
        voltage,
        ("x", "v", "voltage") if gated else ("x", "v"),
        noise,
        float(np.var(left) / np.var(force)),
        truth | {"lag": lag, "gated": float(gated), "rate": rate},
    )


def _motion(rng: np.random.Generator, t: Floats, stroke: float) -> Floats:
    """Sines, a slow sweep, or filtered noise."""
    base = 2.0 * np.pi * rng.uniform(0.4, 2.0)
    how = rng.integers(3)
    if how == 0:
        parts = [(1.0, 1.0), (0.5, 0.37), (0.3, 1.7)]
        return sum(stroke * a * np.sin(base * f * t + rng.uniform(0.0, 6.0)) for a, f in parts)
    if how == 1:
        grown = 0.3 + 0.7 * np.sin(np.pi * t / t[-1]) ** 2
        return stroke * grown * np.sin(base * t * (0.4 + 0.6 * t / t[-1]))
    spectrum = np.fft.rfft(rng.standard_normal(t.size))
    omega = 2.0 * np.pi * np.fft.rfftfreq(t.size, t[1])
    x = np.fft.irfft(spectrum * np.exp(-((omega / base) ** 2)), t.size)
    return stroke * x / np.abs(x).max()


def _voltage(rng: np.random.Generator, t: Floats, rate: float) -> tuple[Floats, Floats, float]:
    """Steps or a slow wave of the voltage, and the current that follows it."""
    lag, largest = float(10.0 ** rng.uniform(-2.5, -1.0)), float(rng.choice([2.0, 5.0, 10.0]))
    if rng.random() < 0.7:
        held = rng.uniform(0.0, largest, int(t[-1]) + 2)
        voltage = held[np.minimum((t * rng.uniform(0.7, 1.6)).astype(int), held.size - 1)]
    else:
        voltage = 0.5 * largest * (1.0 + np.sin(2.0 * np.pi * rng.uniform(0.1, 0.7) * t))
    keep = np.exp(-1.0 / (rate * lag))
    current = np.empty_like(voltage)
    current[0] = voltage[0]
    for k in range(1, t.size):
        current[k] = keep * current[k - 1] + (1.0 - keep) * voltage[k - 1]
    return voltage, current, lag


def _force(
    rng: np.random.Generator, t: Floats, x: Floats, current: Floats, stroke: float
) -> tuple[Floats, dict[str, float]]:
    """What resists: a spring, a damper and a loop, the last two gated."""
    largest = max(float(current.max()), 1.0)
    loop, viscous = rng.uniform(200.0, 1000.0), rng.uniform(0.1, 0.5)
    spring = rng.choice([0.0, rng.uniform(0.05, 0.4)]) * loop / stroke
    growth, stiffer = rng.uniform(0.5, 4.0, 2) / largest
    yielding, sharp, round_ = (
        rng.uniform(0.03, 0.3) * stroke,
        float(rng.choice([1.0, 2.0])),
        rng.uniform(0.5, 0.9),
    )
    speed = np.gradient(x, t)
    damping = viscous * loop / float(np.abs(speed).max())
    z, loops = 0.0, np.zeros_like(t)
    for k in range(1, t.size):
        part = (x[k] - x[k - 1]) / INNER / yielding
        for _ in range(INNER):
            z += part * (1.0 - (round_ * np.sign(part * z) + 1.0 - round_) * abs(z) ** sharp)
        loops[k] = z
    force = spring * x + damping * (1.0 + growth * current) * speed + loop * (1.0 + stiffer * current) * loops
    truth = {"spring": float(spring), "damping": damping, "loop": loop, "yield": yielding, "sharpness": sharp}
    return force, truth


def write_csv(damper: Damper, path: Path) -> None:
    """The file of a data logger."""
    columns = np.stack([damper.t, 1e3 * damper.x, 1e-3 * damper.force, damper.voltage], axis=1)
    np.savetxt(path, columns, "%.7g", ",", header="t [s],stroke [mm],load cell [kN],voltage [V]", comments="")
