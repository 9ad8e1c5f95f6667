"""All signals seen through the same smooth window, with exact rates: relations between them stay as they are.

A convolution with a bell is the same for every signal, and the rate of the bell gives the rate of the signal
without differences of noisy samples. So ``v = dx/dt`` or ``m a + c v + k x = F`` hold between smoothed
signals exactly as they hold between the true ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import (
    SMOOTH_FEWEST_POINTS,
    SMOOTH_LARGEST_SHARE,
    SMOOTH_LEAST_GAP,
    SMOOTH_LEAST_WIDTH,
    SMOOTH_POINTS_PER_WIDTH,
    SMOOTH_POWER_SHARE,
    SMOOTH_REACH_STDS,
)
from rthm_analysis.diagnosis.faults.stretches import flagged, held_commands, stretches
from rthm_analysis.diagnosis.replay.evidence import MOTION, Channel, Evidence
from rthm_analysis.diagnosis.signals import filled

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers


@dataclass(frozen=True)
class Smooth:
    """Smoothed signals at some instants.

    Attributes
    ----------
    width : float
        Standard deviation of the bell, s.
    step : float
        Between two samples, s.
    rows : (p,) array
        Samples at which the signals are given: away from gaps and ends.
    values, rates : dict of (p,) arrays
        By family and place; ``("command", actuator)`` and ``("load", dof)`` are among them.
    seconds : dict of (p,) arrays
        Second derivatives, of the motion.
    """

    width: float
    step: float
    rows: Integers
    values: dict[tuple[str, str], Floats]
    rates: dict[tuple[str, str], Floats]
    seconds: dict[tuple[str, str], Floats]


@lru_cache(maxsize=1)
def smoothed(evidence: Evidence, dofs: tuple[str, ...], actuators: tuple[str, ...]) -> Smooth | None:
    """Signals of an evidence through one bell; None where too little is known.

    Most recordings have no fault, so that one step after the other asks for the same: the last is kept.

    Parameters
    ----------
    evidence : Evidence
    dofs, actuators : tuple of str
        Names of the columns of its load and of its commands.
    """
    signals = _signals(evidence, dofs, actuators)
    step = float(np.median(np.diff(evidence.time)))
    positions = [column for (family, _), column in signals.items() if family == "position"]
    first = positions or [column for (family, _), column in signals.items() if family == "velocity"]
    if not first or step <= 0.0:
        return None
    width = min(
        min(_width(filled(one), step) for one in first), SMOOTH_LARGEST_SHARE * evidence.stamps_ns.size * step
    )
    width = max(width, SMOOTH_LEAST_WIDTH * step)
    rows = _rows(evidence, width, step)
    if rows.size < SMOOTH_FEWEST_POINTS:
        return None
    size = evidence.stamps_ns.size
    padded = good_length(size + int(2 * SMOOTH_REACH_STDS * width / step))
    omega = 2.0 * np.pi * np.fft.rfftfreq(padded, step)
    bell = np.exp(-0.5 * np.square(omega * width))
    values, rates, seconds = {}, {}, {}
    for name, column in signals.items():
        if name[0] == "load" and not column.any():
            values[name] = rates[name] = np.zeros(rows.size)
            continue
        whole = filled(column)
        spectrum = np.fft.rfft(whole - whole.mean(), padded) * bell
        values[name] = np.fft.irfft(spectrum, padded)[rows] + whole.mean()
        rates[name] = np.fft.irfft(1j * omega * spectrum, padded)[rows]
        if name[0] in MOTION:
            seconds[name] = np.fft.irfft(-np.square(omega) * spectrum, padded)[rows]
    return Smooth(width, step, rows, values, rates, seconds)


def _signals(
    evidence: Evidence, dofs: tuple[str, ...], actuators: tuple[str, ...]
) -> dict[tuple[str, str], Floats]:
    """Everything that was measured or is known to have acted, by family and place; no channel that
    never changes.
    """
    signals = {
        (one.family, one.place): evidence.measured[:, i]
        for i, one in enumerate(evidence.channels)
        if np.nanmax(evidence.measured[:, i]) > np.nanmin(evidence.measured[:, i])
    }
    signals |= {("load", dof): column for dof, column in zip(dofs, evidence.load.T, strict=True)}
    if evidence.driven_by == "command":
        held = held_commands(evidence).T
        signals |= {("command", name): column for name, column in zip(actuators, held, strict=True)}
    return signals


def channel_at(evidence: Evidence, family: str, place: str) -> int | None:
    """Column of a channel; None where it was not measured."""
    wanted = Channel(family, place)
    return evidence.channels.index(wanted) if wanted in evidence.channels else None


def _width(values: Floats, step: float) -> float:
    """Width of the bell that lets most of a signal pass, s."""
    moved = values - np.linspace(float(values[0]), float(values[-1]), values.size)
    power = np.square(np.abs(np.fft.rfft(moved * np.hanning(values.size))))
    power[0] = 0.0
    total = np.cumsum(power)
    if not total[-1] > 0.0:
        return 10.0 * step
    edge = int(np.searchsorted(total, SMOOTH_POWER_SHARE * total[-1]))
    return values.size * step / (2.0 * np.pi * max(edge, 1)) / 1.5


def _rows(evidence: Evidence, width: float, step: float) -> Integers:
    """Samples whose bell does not reach over an end or a longer gap."""
    size, reach = evidence.stamps_ns.size, int(np.ceil(SMOOTH_REACH_STDS * width / step))
    every = max(int(width / step / SMOOTH_POINTS_PER_WIDTH), 1)
    rows = np.arange(reach, size - reach, every)
    longest = max(int(0.3 * width / step), SMOOTH_LEAST_GAP)
    unknown = np.zeros(size, dtype=bool)
    for column in evidence.measured.T:
        unknown |= flagged(
            [one for one in stretches(~np.isfinite(column)) if one[1] - one[0] > longest], size
        )
    late = np.abs(np.diff(evidence.time, append=evidence.time[-1] + step) - step) > 0.5 * step
    bad = np.concatenate([[0], np.cumsum(unknown | late)])
    many = bad[np.minimum(rows + reach, size)] - bad[np.maximum(rows - reach, 0)]
    return np.asarray(rows[many == 0])


def good_length(least: int) -> int:
    """Length, not below the least, for which a transform is quick: 2^a or 3 * 2^a."""
    power = 1 << max(least - 1, 1).bit_length()
    return 3 * power // 4 if 3 * power // 4 >= least else power
