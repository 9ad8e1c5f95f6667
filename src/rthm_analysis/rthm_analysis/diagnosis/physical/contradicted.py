"""Errors of one channel that another channel of the same dof denies: no motion and no force made them."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.noise import DENYING_POWER_RATIO, SLOW_SAMPLES
from rthm_analysis.diagnosis.physical.remainder import averages
from rthm_analysis.diagnosis.physical.shown_elsewhere import lacks
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.evidence import MOTION, Channel
from rthm_core.compiled import Floats
from rthm_core.substructure import interface, substructure

PARTNERS = {
    "position": ("velocity", "force"),
    "velocity": ("position",),
    "acceleration": ("velocity", "position"),
    "force": ("position",),
}
"""Signals of the same dof in which errors of a signal would show."""


def denied(physical: Physical, predicted: Floats, channel: int) -> bool:
    """Whether what is left of a position or a rate is no motion, since another signal of the dof does not
    show it; or what is left of a force no force, since the plant does not move by it.

    Such errors are the sensor's own: noise that wanders within the band of the motion, where its spectrum
    cannot be told.
    """
    here = physical.evidence.channels[channel]
    dof = _dof(physical, here)
    return any(
        _denied_by(physical, predicted, (channel, other), dof)
        for other, one in enumerate(physical.evidence.channels)
        if one.family in PARTNERS.get(here.family, ()) and _dof(physical, one) == dof
    )


def _denied_by(physical: Physical, predicted: Floats, pair: tuple[int, int], dof: int) -> bool:
    """Whether the second of two channels would show what the first leaves, and does not."""
    evidence, (channel, other) = physical.evidence, pair
    families = evidence.channels[channel].family, evidence.channels[other].family
    step = float(np.median(np.diff(evidence.time))) * SLOW_SAMPLES
    left = evidence.measured - predicted
    here, there = (averages(np.nan_to_num(left[:, k])) for k in pair)
    noise = (
        np.random.default_rng(0).normal(size=here.size)
        * physical.noise.sigma[channel]
        / np.sqrt(SLOW_SAMPLES)
    )
    omega = np.asarray(2.0 * np.pi * np.fft.rfftfreq(here.size, step), dtype=float)
    response = _response(physical, families, dof, omega)
    shown, chance = (_shown(one, families, step, response) for one in (here, noise))
    power, usual = float(shown @ shown), float(chance @ chance)
    of_noise = here.size * float(physical.noise.sigma[other]) ** 2 / SLOW_SAMPLES
    if power - 2.0 * usual < DENYING_POWER_RATIO * of_noise:
        return False
    return lacks(there, shown)


def _dof(physical: Physical, channel: Channel) -> int:
    """Dof of the plant at which a channel is, or on which its actuator acts."""
    assert physical.spec.plant is not None
    if channel.family == "force":
        names = physical.spec.loop().actuator.names
        return int(interface(physical.spec).plant[names.index(channel.place)])
    return physical.spec.plant.dofs.index(channel.place)


def _response(physical: Physical, families: tuple[str, str], dof: int, omega: Floats) -> Floats:
    """Response (f,) of the second signal to the first, where one is a force.

    Of a dof that is held by its wires to a force on it, m/N; of the force of its wires to its motion, N/m.
    """
    spec = physical.spec
    assert spec.plant is not None
    if "force" not in families:
        return np.ones(omega.size)
    held, wire = interface(spec).plant, np.array(spec.k_tot)
    if families[1] == "force":
        return np.full(omega.size, -float(wire[held == dof].sum()))
    plant = substructure(spec.plant)
    stiffness = plant.stiffness.copy()
    stiffness[held, held] += wire
    at = omega[:, None, None]
    return np.asarray(np.linalg.inv(stiffness - at**2 * plant.mass + 1j * at * plant.damping)[:, dof, dof])


def _shown(slow: Floats, families: tuple[str, str], step: float, response: Floats) -> Floats:
    """What errors of a signal would make of another."""
    if "force" in families:
        return np.fft.irfft(np.fft.rfft(slow - slow.mean()) * response, slow.size)
    rates = MOTION.index(families[1]) - MOTION.index(families[0])
    for _ in range(rates):
        slow = np.gradient(slow, step)
    for _ in range(-rates):
        moved, at = np.cumsum(slow - slow.mean()) * step, np.arange(slow.size)
        slow = moved - np.polyval(np.polyfit(at, moved, 2), at)
    return slow
