"""A rig identified: noise, motors, wires, and the entries of the spec that follow from them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.identification.evidence import Motion, motions_of
from rthm_analysis.identification.motor import DELAY, FAST, GAIN, SHORTEST, SLOW, Motor, fitted_motor
from rthm_analysis.identification.noise import noise_at_rest
from rthm_analysis.identification.result import Figure, Identified
from rthm_analysis.identification.wire import signs, stiffness
from rthm_core.clock import NS
from rthm_core.excitation import QUIET_START

if TYPE_CHECKING:
    from rthm_analysis.recording import Recording
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec

INSTANT = 1e-3
"""Time constant of a motor that has none, over Td1: h(s) needs two."""
SPEC_DIGITS = 6
"""Digits of the numbers that go into a spec."""


def identified(recording: Recording, spec: Spec) -> Identified:
    """Identify the rig of a recording in which its motors were moved on purpose."""
    found = identify(motions_of(recording, spec), spec)
    age = (recording.plant.received_ns - recording.plant.stamp_ns) / NS
    late = float(np.quantile(age, 0.99))
    words = (
        "99 % of the samples are there by then; tau1 and tau2 are kept by the receivers, and must be longer"
    )
    arrival = Figure("arrival of plant/state", "s", late, float(np.std(age)), spec.loop().timing.tau1, words)
    return Identified((*found.figures, arrival), found.wrong, found.changes)


def identify(motions: Sequence[Motion], spec: Spec) -> Identified:
    """Identify a rig from what its actuators did.

    Parameters
    ----------
    motions
        One for each actuator, in the order of the spec.
    spec
        What is claimed; a number that the motions do not show stays as it is there.

    Examples
    --------
    A recording without commands says so:

    >>> from rthm_core.spec import shipped_spec
    >>> none, t = np.empty(0), 0.0012 * np.arange(2000)
    >>> still = Motion("a1", "x1", t, *np.zeros((4, 2000)), none, none)
    >>> [figure.words for figure in identify([still], shipped_spec()).figures if "delay" in figure.name]
    ['as no commands were recorded']
    """
    noise = list(_noise(motions, spec))
    motors = [_motor(motion, spec) for motion in motions]
    wires = [_wire(i, motion, spec) for i, motion in enumerate(motions)]
    gains = [motor.value[GAIN] if motor else 1.0 for motor, _ in motors]
    wrong = [
        words for motion, gain in zip(motions, gains, strict=True) for words in _wrong(motion, float(gain))
    ]
    figures = [*(one for _, found in motors for one in found), *wires, *noise]
    changes = (
        _of_motors([m for m, _ in motors if m], motions, spec) | _of_wires(wires, spec) | _of_noise(noise)
    )
    return Identified(tuple(figures), tuple(wrong), {} if wrong else changes)


def _wrong(motion: Motion, gain: float) -> list[str]:
    channels = motion.motor, motion.force, motion.position
    return signs(motion, gain) if all(map(_is_known, channels)) and motion.command.size else []


def _is_known(values: Floats) -> bool:
    return bool(values.size > 100 and np.isfinite(values).all())


def _motor(motion: Motion, spec: Spec) -> tuple[Motor | None, list[Figure]]:
    """Fit the motor of one actuator; its figures."""
    loop, name = spec.loop(), motion.actuator
    poles = sorted(loop.actuator.motor_poles or ())
    delay, pole = f"delay of the motor of {name}", f"pole of the motor of {name}"
    why = _why_no_motor(motion)
    if why:
        return None, [Figure(delay, "s", words=why), Figure(pole, "rad/s", words=why)]
    believed = (1.0 / poles[0], 1.0 / poles[1]) if poles else (0.0, 0.0)
    motor = fitted_motor(motion, loop.timing.td1, believed)
    value, std = motor.value, motor.std
    figures = [
        Figure(
            delay, "s", value[DELAY] + (motion.waited or 0.0), std[DELAY], loop.timing.tau4, _waited(motion)
        )
    ]
    for which, claimed in zip((SLOW, FAST), poles or (None, None), strict=True):
        if motor.seen[which]:
            spread = std[which] / value[which] ** 2
            figures.append(Figure(pole, "rad/s", 1.0 / value[which], spread, claimed))
        else:
            kept = "; the spec's does as well" if value[which] > SHORTEST else "; it is in the delay"
            words = f"as it is too quick to be seen{kept}"
            figures.append(Figure(pole, "rad/s", claimed=claimed, words=words))
    return motor, figures


def _why_no_motor(motion: Motion) -> str:
    if not motion.command.size:
        return "as no commands were recorded"
    if not _is_known(motion.motor):
        return "as the position of the motor is not measured"
    if not np.ptp(motion.command) > 0.0:
        return "as nothing was commanded to move"
    return "" if np.ptp(motion.motor) > 0.0 else "as the motor did not move"


def _waited(motion: Motion) -> str:
    """What of a delay is whose."""
    if motion.waited is None:
        return "from the stamp of a command to the motion by the stamps of plant/state"
    return f"the driver says that it keeps commands for {motion.waited:.6g} s of it"


def _wire(i: int, motion: Motion, spec: Spec) -> Figure:
    name, claimed = f"k_tot of {motion.actuator}", spec.k_tot[i]
    channels = {"motor": motion.motor, "force": motion.force, motion.dof: motion.position}
    missing = [channel for channel, values in channels.items() if not _is_known(values)]
    if missing:
        return Figure(name, "N/m", claimed=claimed, words=f"as {' and '.join(missing)} were not measured")
    fit = stiffness(motion)
    if not fit.is_certain(0):
        return Figure(name, "N/m", claimed=claimed, words="as no elongation shows in the force")
    words = f"{fit.value[1]:.3g} N where nothing is stretched"
    return Figure(name, "N/m", float(fit.value[0]), float(fit.std[0]), claimed, words)


def _noise(motions: Sequence[Motion], spec: Spec) -> list[Figure]:
    found = {}
    for motion in motions:
        still = motion.time < QUIET_START
        for kind, unit, where in (
            ("position", "m", motion.dof),
            ("velocity", "m/s", motion.dof),
            ("motor", "m", motion.actuator),
            ("force", "N", motion.actuator),
        ):
            level, std = noise_at_rest(getattr(motion, kind)[still])
            words = "" if np.isfinite(level) else "as it is not measured"
            name = f"noise of {kind} of {where}"
            found[name] = Figure(name, unit, level, std, getattr(spec.noise, kind), words)
    return list(found.values())


def _of_motors(motors: Sequence[Motor], motions: Sequence[Motion], spec: Spec) -> dict[str, Any]:
    """Entries of timing and motors: one for all actuators, each weighed by how well it is known."""
    if not motors:
        return {}
    changes: dict[str, Any] = {}
    if all(motion.waited is None for motion in motions):
        changes["timing.tau4"] = _rounded(max(_mean(motors, DELAY), 0.0))
    constants = [_mean(motors, which) for which in (SLOW, FAST)]
    least = INSTANT * spec.loop().timing.td1
    poles = [_rounded(1.0 / max(constant, least)) for constant in constants]
    changes["actuator.motor_poles"] = poles if max(constants) > least else None
    return changes


def _mean(motors: Sequence[Motor], which: int) -> float:
    weights = [1.0 / max(motor.std[which], 1e-12) ** 2 for motor in motors]
    return float(np.average([motor.value[which] for motor in motors], weights=weights))


def _of_wires(wires: Sequence[Figure], spec: Spec) -> dict[str, Any]:
    """Stiffness of all actuators; that of a transmission follows from its parts, and is only told."""
    if not any(wire.known for wire in wires) or spec.loop().actuator.transmission is not None:
        return {}
    values = [_rounded(w.value) if w.known else k for w, k in zip(wires, spec.k_tot, strict=True)]
    known = spec.uncertainty.actuator.stiffness
    spread = [wire.std / wire.value if wire.known else known for wire in wires]
    return {"actuator.stiffness": values, "uncertainty.actuator.stiffness": _rounded(max(spread))}


def _of_noise(noise: Sequence[Figure]) -> dict[str, Any]:
    """Noise of each kind of sensor: that of the noisiest one."""
    kinds: dict[str, float] = {}
    for one in noise:
        kind = f"noise.{one.name.split()[2]}"
        if one.known:
            kinds[kind] = max(kinds.get(kind, 0.0), _rounded(one.value))
    return kinds


def _rounded(value: float) -> float:
    return float(f"{value:.{SPEC_DIGITS}g}")
