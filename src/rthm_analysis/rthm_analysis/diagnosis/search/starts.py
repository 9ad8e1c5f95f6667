"""Where the search for each kind of effect begins: its starting-value finder.

A start names the parameters that a fit may move, and the one, `amplitude`, in which the effect is nearly
linear: its size is then estimated from one replay. Kinds that only act beyond a threshold have none: their
starts are tried as they are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.search.scene import Scene, rms
from rthm_core.compiled import Floats
from rthm_core.effects import effect, kinds

PEAK = 2.0
"""Width over which a spectrum is averaged before its peaks are taken, rad/s."""

STANDS_OUT = 6.0
"""Standard deviations by which a peak must rise above the noise of a spectrum."""

SMALL = 0.02
"""Force of an effect in its trial replay, as a part of the force that drives the dof."""


@dataclass(frozen=True)
class InitialGuess:
    """An initial guess of an effect.

    `also` is a second parameter in which it is linear by itself; `look_elsewhere` is the gain that the best
    of all places where it was looked for has by chance, beyond what every kind has to bring.
    """

    added: EffectInstance
    free: tuple[str, ...]
    amplitude: tuple[str, ...]
    scales: dict[str, float] = field(default_factory=dict)
    signed: bool = False
    neutral: float = 0.0
    also: str | None = None
    look_elsewhere: float = 0.0

    @property
    def label(self) -> tuple[str, str, str]:
        """Block, kind and place."""
        return self.added.block, self.added.kind, self.added.place

    def added_to(self, model: Model) -> Model:
        """A model with this effect, as large as it is here."""
        return model.plus(self.added, self.free, self.scales)

    @property
    def doubled(self) -> InitialGuess:
        """The same start with twice the parameter `also`."""
        assert self.also is not None
        values = dict(self.added.parameters)
        values[self.also] = 2.0 * float(values[self.also])
        return replace(self, added=replace(self.added, parameters=values))

    def with_also(self, factor: float) -> InitialGuess:
        """The same start with the parameter `also` times a factor, which is kept positive."""
        assert self.also is not None
        values = dict(self.added.parameters)
        values[self.also] = max(factor, 0.05) * float(values[self.also])
        scales = self.scales | {self.also: float(values[self.also])}
        return replace(self, added=replace(self.added, parameters=values), scales=scales)

    @property
    def trial(self) -> float:
        """Size of the first amplitude in the trial replay."""
        return abs(float(self.added.parameters[self.amplitude[0]]) - self.neutral)

    def sized(self, factor: float) -> InitialGuess:
        """The same start with its amplitude times a factor."""
        values = dict(self.added.parameters)
        for key in self.amplitude:
            values[key] = self.neutral + factor * (float(values[key]) - self.neutral)
        scales = {key: abs(float(values[key]) - self.neutral) or self.scales[key] for key in self.amplitude}
        return replace(self, added=replace(self.added, parameters=values), scales=self.scales | scales)


PAIRED = ("pulley_inertia", "end_stop", "stribeck_friction")
"""Kinds with two parameters in each of which they are linear."""

Finder = Callable[[Scene], Iterator[InitialGuess]]


def _start(
    s: Scene, block: str, kind: str, amplitude: tuple[str, ...], signed: bool = False, **p: float
) -> InitialGuess:
    scales = {key: abs(value) for key, value in p.items() if value}
    free = tuple(key for key in p if key != "A")
    also = amplitude[1] if kind in PAIRED else None
    return InitialGuess(
        EffectInstance(block, kind, s.place, dict(p), s.seen), free, amplitude, scales, signed, also=also
    )


def coulomb_friction(s: Scene) -> Iterator[InitialGuess]:
    """Seen at once in its amplitude."""
    yield _start(s, "plant", "coulomb_friction", ("force",), force=SMALL * s.size)


def stribeck_friction(s: Scene) -> Iterator[InitialGuess]:
    """Two widths of the fall from static to sliding friction."""
    f = SMALL * s.size
    for velocity in (0.05, 0.2):
        yield _start(
            s,
            "plant",
            "stribeck_friction",
            ("coulomb_force", "static_force"),
            coulomb_force=f,
            static_force=1.6 * f,
            stribeck_velocity=velocity * rms(s.v),
        )


def quadratic_drag(s: Scene) -> Iterator[InitialGuess]:
    """Linear in its coefficient."""
    yield _start(s, "plant", "quadratic_drag", ("coefficient",), coefficient=SMALL * s.size / rms(s.v**2))


def cubic_stiffness(s: Scene) -> Iterator[InitialGuess]:
    """Linear in its coefficient, of either sign."""
    yield _start(
        s, "plant", "cubic_stiffness", ("coefficient",), True, coefficient=SMALL * s.size / rms(s.x**3)
    )


def quadratic_stiffness(s: Scene) -> Iterator[InitialGuess]:
    """Linear in its coefficient, of either sign."""
    c = SMALL * s.size / rms(s.x**2)
    yield _start(s, "plant", "quadratic_stiffness", ("coefficient",), True, coefficient=c)


def end_stop(s: Scene) -> Iterator[InitialGuess]:
    """A stop on either side, reached for 2 to 30 % of the time."""
    for side in (1.0, -1.0):
        for share in (0.02, 0.06, 0.15, 0.3):
            position = float(np.quantile(side * s.x, 1.0 - share))
            if position <= 0.0:
                continue
            depth = rms(np.maximum(side * s.x - position, 0.0))
            if depth <= 0.0:
                continue
            k = SMALL * s.size / depth
            yield _start(
                s,
                "plant",
                "end_stop",
                ("stiffness", "damping"),
                position=side * position,
                stiffness=k,
                damping=1e-3 * k,
            )


def clearance(s: Scene) -> Iterator[InitialGuess]:
    """A gap left for 10 to 70 % of the time."""
    for share in (0.1, 0.25, 0.45, 0.7):
        gap = s.level(s.x, share)
        depth = rms(np.maximum(np.abs(s.x) - gap, 0.0))
        if depth > 0.0:
            yield _start(s, "plant", "clearance", ("stiffness",), gap=gap, stiffness=SMALL * s.size / depth)


def _bouc_wen(s: Scene, block: str, reach: float) -> Iterator[InitialGuess]:
    """Loops that yield early or late, that bulge (gamma > 0) or pinch and stiffen (gamma < 0)."""
    for share, n, beta, gamma in (
        (0.12, 1.0, 0.65, 0.35),
        (0.3, 1.0, 0.65, 0.35),
        (0.3, 2.0, 0.65, 0.35),
        (0.8, 1.0, 0.65, 0.35),
        (0.8, 1.0, 0.5, -0.5),
        (2.0, 1.0, 0.5, -0.7),
    ):
        z = share * reach
        alpha, total = SMALL * s.size / min(z, reach), z**-n
        yield _start(
            s, block, "bouc_wen", ("alpha",), alpha=alpha, A=1.0, beta=beta * total, gamma=gamma * total, n=n
        )


def bouc_wen(s: Scene) -> Iterator[InitialGuess]:
    """Loops of a hysteretic spring."""
    yield from _bouc_wen(s, "plant", rms(s.x - s.x.mean()))


def maxwell_branch(s: Scene) -> Iterator[InitialGuess]:
    """Relaxation slower than, as fast as and faster than the motion."""
    for ratio in (0.3, 1.0, 3.0):
        k = SMALL * s.size / rms(s.x - s.x.mean())
        yield _start(
            s,
            "plant",
            "maxwell_branch",
            ("stiffness", "damping"),
            stiffness=k,
            damping=k / (ratio * s.frequency),
        )


def hidden_mode(s: Scene) -> Iterator[InitialGuess]:
    """Resonators below, at and above the main frequency."""
    for ratio in np.geomspace(0.45, 4.0, 14):
        yield _start(
            s,
            "plant",
            "hidden_mode",
            ("mass",),
            mass=0.01 * s.mass,
            frequency=float(ratio) * s.frequency,
            damping_ratio=0.05,
        )


def fluid_memory(s: Scene) -> Iterator[InitialGuess]:
    """Memory that peaks below, at and above the main frequency."""
    for ratio in (0.5, 0.8, 1.2, 1.8, 2.7):
        yield _start(
            s,
            "plant",
            "fluid_memory",
            ("gain",),
            gain=SMALL * s.size / rms(s.v) * s.frequency,
            frequency=ratio * s.frequency,
            damping_ratio=0.3,
        )


def constant_load(s: Scene) -> Iterator[InitialGuess]:
    """Linear in its force."""
    yield _start(s, "plant", "constant_load", ("force",), True, force=SMALL * s.size)


def backlash(s: Scene) -> Iterator[InitialGuess]:
    """Nearly linear in a small gap; a larger one moves the plant otherwise."""
    for part in (SMALL, 0.1, 0.4):
        yield _start(s, "wire", "backlash", ("gap",), gap=part * rms(s.elongation))


def slack(s: Scene) -> Iterator[InitialGuess]:
    """Tensions that are lost for 0.5 to 30 % of the time."""
    reaction = -s.force
    for share in (0.005, 0.02, 0.06, 0.15, 0.3):
        level = float(np.quantile(reaction, 1.0 - share))
        if level > 0.0:
            start = _start(s, "wire", "slack", (), pretension=level)
            start.scales["pretension"] = 0.2 * s.size
            yield start


def hardening(s: Scene) -> Iterator[InitialGuess]:
    """Linear in its coefficient, of either sign."""
    c = SMALL * s.size / rms(s.elongation**3)
    yield _start(s, "wire", "hardening", ("coefficient",), True, coefficient=c)


def pulley_inertia(s: Scene) -> Iterator[InitialGuess]:
    """A pulley of half a per cent of the dof's mass, and those that would ring as the wire's force does."""
    masses = [5e-3 * s.mass]
    if s.left.size:
        masses += [4.0 * s.stiffness / w**2 for w in peaks(s.time, s.left, 3.0 * s.frequency)]
    for mass in masses:
        damping = 0.05 * np.sqrt(s.stiffness * mass)
        yield _start(s, "wire", "pulley_inertia", ("mass", "damping"), mass=mass, damping=damping)


def peaks(time: Floats, signal: Floats, lowest: float, most: int = 2) -> list[float]:
    """Frequencies above `lowest`, rad/s, at which a signal rings most, and more than noise would.

    The spectrum is smoothed by PEAK.
    """
    step = float(np.median(np.diff(time)))
    even = np.interp(np.arange(time[0], time[-1], step), time, signal)
    omega = 2.0 * np.pi * np.fft.rfftfreq(even.size, step)
    width = max(int(PEAK / omega[1]), 1)
    power = np.convolve(np.abs(np.fft.rfft(even - even.mean())) ** 2, np.ones(width), "same")
    power[omega < lowest] = 0.0
    floor = float(np.median(power[power > 0.0])) * (1.0 + STANDS_OUT / np.sqrt(width)) if power.any() else 0.0
    found = []
    for _ in range(most):
        best = int(np.argmax(power))
        if power[best] > floor:
            found.append(float(omega[best]))
        power[max(best - 2 * width, 0) : best + 2 * width] = 0.0
    return found


def pulley_friction(s: Scene) -> Iterator[InitialGuess]:
    """Nearly linear in a small force."""
    yield _start(s, "wire", "pulley_friction", ("force",), force=2.0 * SMALL * s.size)


def wire_bouc_wen(s: Scene) -> Iterator[InitialGuess]:
    """Loops of a hysteretic wire."""
    yield from _bouc_wen(s, "wire", rms(s.elongation))


def wire_maxwell_branch(s: Scene) -> Iterator[InitialGuess]:
    """Relaxation slower than, as fast as and faster than the motion."""
    for ratio in (0.3, 1.0, 3.0):
        k = SMALL * s.size / rms(s.elongation)
        yield _start(
            s,
            "wire",
            "maxwell_branch",
            ("stiffness", "damping"),
            stiffness=k,
            damping=k / (ratio * s.frequency),
        )


def declared(block: str, scene: Scene) -> Iterator[InitialGuess]:
    """Starts of all kinds of a block that say themselves where a fit may begin."""
    for kind in kinds(block):
        for guess in effect(kind, block).guesses(scene):
            values = {key: float(value) for key, value in guess.values.items()}
            added = EffectInstance(block, kind, scene.place, dict(values), scene.seen)
            scales = {key: abs(value) for key, value in values.items() if value}
            yield InitialGuess(added, tuple(values), guess.linear, scales, guess.signed)


PLANT: dict[str, Finder] = {
    "coulomb_friction": coulomb_friction,
    "stribeck_friction": stribeck_friction,
    "quadratic_drag": quadratic_drag,
    "cubic_stiffness": cubic_stiffness,
    "quadratic_stiffness": quadratic_stiffness,
    "end_stop": end_stop,
    "clearance": clearance,
    "bouc_wen": bouc_wen,
    "maxwell_branch": maxwell_branch,
    "hidden_mode": hidden_mode,
    "fluid_memory": fluid_memory,
    "constant_load": constant_load,
}

WIRE: dict[str, Finder] = {
    "backlash": backlash,
    "slack": slack,
    "hardening": hardening,
    "pulley_inertia": pulley_inertia,
    "pulley_friction": pulley_friction,
    "bouc_wen": wire_bouc_wen,
    "maxwell_branch": wire_maxwell_branch,
}
