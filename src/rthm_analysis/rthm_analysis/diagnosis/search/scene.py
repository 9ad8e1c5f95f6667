"""How large things are in a recording: what starting values of effects are scaled by."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from rthm_analysis.diagnosis.criteria.search import PEAK_STDS, PEAK_WIDTH
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.experiment import Motion
from rthm_core.compiled import Floats
from rthm_core.effects.guess import rms
from rthm_core.effects.possible import Seen
from rthm_core.spec import Spec
from rthm_core.spec.effect import between


@dataclass(frozen=True)
class Scene:
    """Motion of one dof, or of one actuator and its dof, in the recorded test.

    Attributes
    ----------
    place : str
        Dof or actuator.
    x, v, a : (s,) arrays
        Motion of the dof.
    force : (s,) array
        What drives it: wire forces and known loads, N.
    elongation : (s,) array
        Of the wire, m; empty where there is none.
    mass, stiffness : float
        Of the dof, and of the wire.
    time : (s,) array
        Of the samples, s.
    left : (s,) array
        What a linear wire leaves of the recorded force, N; empty where none was recorded.
    """

    place: str
    x: Floats
    v: Floats
    a: Floats
    force: Floats
    elongation: Floats
    mass: float
    stiffness: float
    time: Floats
    left: Floats = field(default_factory=lambda: np.empty(0))

    @property
    def frequency(self) -> float:
        """Where most of the motion is, rad/s."""
        return rms(self.v) / max(rms(self.x - self.x.mean()), 1e-300)

    @property
    def size(self) -> float:
        """Force scale, N."""
        return max(rms(self.force), self.mass * rms(self.a), 1e-300)

    @cached_property
    def seen(self) -> Seen:
        """What it shows of effects that act here."""
        shown = seen_in(self.time)
        reached = {"lowest": float(self.x.min()), "highest": float(self.x.max())}
        return replace(shown, mass=self.mass, speed=float(np.abs(self.v).max()), **reached)

    def ringing(self, lowest: float) -> list[float]:
        """Frequencies above `lowest`, rad/s, at which what a linear wire leaves of its force rings most."""
        return peaks(self.time, self.left, lowest) if self.left.size else []


def peaks(time: Floats, signal: Floats, lowest: float, most: int = 2) -> list[float]:
    """Frequencies above `lowest`, rad/s, at which a signal rings most, and more than noise would.

    The spectrum is smoothed by PEAK_WIDTH.
    """
    step = float(np.median(np.diff(time)))
    even = np.interp(np.arange(time[0], time[-1], step), time, signal)
    omega = 2.0 * np.pi * np.fft.rfftfreq(even.size, step)
    width = max(int(PEAK_WIDTH / omega[1]), 1)
    power = np.convolve(np.abs(np.fft.rfft(even - even.mean())) ** 2, np.ones(width), "same")
    power[omega < lowest] = 0.0
    floor = float(np.median(power[power > 0.0])) * (1.0 + PEAK_STDS / np.sqrt(width)) if power.any() else 0.0
    found = []
    for _ in range(most):
        best = int(np.argmax(power))
        if power[best] > floor:
            found.append(float(omega[best]))
        power[max(best - 2 * width, 0) : best + 2 * width] = 0.0
    return found


@dataclass(frozen=True)
class SensorScene:
    """Reading of one sensor; attributes as of `rthm_core.effects.guess.SensorSignals`."""

    noise: float
    spread: float
    rate: float
    duration: float


def sensor_scene(time: Floats, reading: Floats, noise: float) -> SensorScene:
    """Scene of a sensor with a reading (s,) at some instants (s,) and a noise of this standard deviation."""
    rate = rms(np.nan_to_num(np.gradient(reading, time)))
    return SensorScene(noise, float(np.nanstd(reading)) or 1.0, rate, float(time[-1]) or 1.0)


def seen_in(time: Floats) -> Seen:
    """What samples at some instants show of any effect."""
    return Seen(float(np.median(np.diff(time))), float(time[-1] - time[0]))


def dof_scene(spec: Spec, evidence: Evidence, motion: Motion, dof: str) -> Scene:
    """Scene of a dof; its recorded position where it is recorded, else the model's."""
    assert spec.plant is not None
    i = spec.plant.dofs.index(dof)
    n = len(spec.plant.dofs)
    x = motion.position[:, i]
    for column, channel in enumerate(evidence.channels):
        if channel.family == "position" and channel.place == dof:
            recorded = evidence.measured[:, column]
            x = np.where(np.isfinite(recorded), recorded, x)
    force = evidence.load[:, i].copy()
    if spec.interface and motion.force.shape[1]:
        for actuator, where in enumerate(spec.interface.plant_dof):
            if where == dof:
                force = force + motion.force[:, actuator]
    mass = float(spec.plant.mass[i * n + i])
    return Scene(
        dof,
        x,
        motion.velocity[:, i],
        evidence.rates(motion.velocity[:, i]),
        force,
        np.empty(0),
        mass,
        0.0,
        evidence.time,
    )


def between_scene(one: Scene, other: Scene) -> Scene:
    """Scene of a dof relative to another: their motion apart, and the mass that resists it."""
    mass = one.mass * other.mass / (one.mass + other.mass)
    force = mass * (one.force / one.mass - other.force / other.mass)
    apart = {name: getattr(one, name) - getattr(other, name) for name in ("x", "v", "a")}
    return replace(one, place=between(one.place, other.place), force=force, mass=mass, **apart)


def wire_scene(spec: Spec, evidence: Evidence, motion: Motion, actuator: str) -> Scene:
    """Scene of an actuator's wire."""
    assert spec.actuator is not None and spec.interface is not None
    i = spec.actuator.names.index(actuator)
    at = dof_scene(spec, evidence, motion, spec.interface.plant_dof[i])
    d = motion.motor[:, i] - at.x
    k = float(spec.k_tot[i])
    left = [
        recorded - k * d
        for one, recorded in zip(evidence.channels, evidence.measured.T, strict=True)
        if one.family == "force" and one.place == actuator
    ]
    known = np.nan_to_num(left[0]) if left else np.empty(0)
    return Scene(actuator, at.x, at.v, at.a, motion.force[:, i], d, at.mass, k, evidence.time, known)
