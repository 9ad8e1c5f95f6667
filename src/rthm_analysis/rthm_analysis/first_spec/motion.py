"""The plant of a recording: matrices from its motion seen through a smooth window, and where it began.

The window is the weak form of the equation of motion: its derivatives stand for those of noisy samples.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.faults.smooth import Smooth, channel_at, smoothed
from rthm_analysis.first_spec.matrices import Matrices, fitted_matrices
from rthm_analysis.first_spec.timing import simplest

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.evidence import Evidence
    from rthm_core.compiled import Floats

CERTAIN = 3.0
"""Standard deviations that a mass has to be above zero to be told by the known forces."""

BETTER = 0.8
"""Ratio of what two readings of the known forces leave from which the better one is taken."""

FEWEST = 8
"""Samples through which the beginning of a motion is drawn."""


def plant_of(
    evidence: Evidence, dofs: tuple[str, ...], wires: dict[str, str], masses: Sequence[float]
) -> tuple[Matrices | None, bool]:
    """Matrices of the plant, and whether known forces tell its masses.

    Parameters
    ----------
    evidence : Evidence
    dofs : tuple of str
    wires : dict
        Dof at which each actuator pulls, where measured forces of actuators drive the plant.
    masses : sequence of float
        Masses that were weighed, kg; empty: to be found.

    Returns
    -------
    Matrices or None
        None where a dof has no recorded position, or the recording is too short. Where no known force tells
        the masses, the first one is 1 kg.
    """
    seen = _seen(evidence, dofs, wires)
    if seen is None:
        return None, False
    motion, force = seen
    driven, given = bool(np.any(force)), list(masses)
    if driven or masses:
        fits = [
            fitted_matrices(motion, one, given or [None] * len(dofs))
            for one in (force, *_held(evidence, dofs, wires))
        ]
        sampled, between = fits[0], fits[-1]
        better = np.sum(np.square(between.left)) < BETTER**2 * np.sum(np.square(sampled.left))
        best = between if better else sampled
        if masses or (np.diag(best.value["mass"]) > CERTAIN * np.diag(best.std["mass"])).all():
            return best, driven
    return fitted_matrices(motion, force, [1.0, *[None] * (len(dofs) - 1)]), False


def _held(evidence: Evidence, dofs: tuple[str, ...], wires: dict[str, str]) -> list[Floats]:
    """Known forces (p, n) where loads are held between their samples: those of half a sample before."""
    load = 0.5 * (evidence.load + np.vstack([evidence.load[:1], evidence.load[:-1]]))
    seen = _seen(replace(evidence, load=load), dofs, wires)
    return [seen[1]] if seen and np.any(evidence.load) else []


def _seen(
    evidence: Evidence, dofs: tuple[str, ...], wires: dict[str, str]
) -> tuple[tuple[Floats, Floats, Floats], Floats] | None:
    """Motion and known forces through the window."""
    smooth = smoothed(evidence, dofs, tuple(wires))
    if smooth is None or any(("position", dof) not in smooth.values for dof in dofs):
        return None
    places = [("position", dof) for dof in dofs]
    motion = tuple(
        _apart([of[one] for one in places]) for of in (smooth.seconds, smooth.rates, smooth.values)
    )
    return motion, _forces(smooth, dofs, wires)  # type: ignore[return-value]


def _forces(smooth: Smooth, dofs: tuple[str, ...], wires: dict[str, str]) -> Floats:
    forces = [smooth.values["load", dof].copy() for dof in dofs]
    for actuator, dof in wires.items():
        if ("force", actuator) in smooth.values:
            forces[dofs.index(dof)] += smooth.values["force", actuator]
    return _apart(forces)


def _apart(columns: Sequence[Floats]) -> Floats:
    """Columns (p, n) without their means."""
    whole = np.column_stack(columns)
    return np.asarray(whole - whole.mean(axis=0))


def with_steps_between(evidence: Evidence, stiffness: Sequence[float]) -> Evidence:
    """Forces of wires whose motors jump, such that straight lines between the samples have the right area.

    A jump between two samples is in the later one alone. For a straight line it is in the middle between
    them, and its true distance from there would be taken for a damping.

    Parameters
    ----------
    evidence : Evidence
        With commands that reach motors without a lag.
    stiffness : sequence of float
        k_tot of each wire, N/m.
    """
    measured, jumps = evidence.measured.copy(), np.diff(evidence.commands, axis=0)
    at, stamps = evidence.due_ns[1:], evidence.stamps_ns
    later = np.searchsorted(stamps, at)
    inside = (later > 0) & (later < stamps.size)
    later, at, jumps = later[inside], at[inside], jumps[inside]
    share = (stamps[later] - at) / (stamps[later] - stamps[later - 1]) - 0.5
    columns = [i for i, channel in enumerate(evidence.channels) if channel.family == "force"]
    for column, jump, k in zip(columns, jumps.T, stiffness, strict=False):
        np.add.at(measured[:, column], later, k * jump * share)
    return replace(evidence, measured=measured)


def beginning(
    evidence: Evidence, dofs: tuple[str, ...], actuators: tuple[str, ...]
) -> tuple[list[float], list[float]]:
    """Position and velocity of every dof at the first sample, from a cubic through the first samples.

    A velocity that is not measured is the slope of the position. Each has the digits that are known of it.
    """
    smooth = smoothed(evidence, dofs, actuators)
    step = float(np.median(np.diff(evidence.time)))
    count = max(FEWEST, round(smooth.width / step) if smooth else 0)
    positions, velocities = [], []
    for dof in dofs:
        position, slope = _start(evidence, "position", dof, count)
        velocity, _ = _start(evidence, "velocity", dof, count)
        positions.append(position or 0.0)
        velocities.append(slope or 0.0 if velocity is None else velocity)
    return positions, velocities


def _start(evidence: Evidence, family: str, dof: str, count: int) -> tuple[float | None, float | None]:
    """Value and slope of a channel at the first sample; None: not known."""
    column = channel_at(evidence, family, dof)
    if column is None:
        return None, None
    time, values = evidence.time[:count] - evidence.time[0], evidence.measured[:count, column]
    known = np.isfinite(values)
    if known.sum() < FEWEST:
        return None, None
    cubic, covariance = np.polyfit(time[known], values[known], 3, cov=True)
    std = np.sqrt(np.diag(covariance))
    return _rounded(float(cubic[3]), float(std[3])), _rounded(float(cubic[2]), float(std[2]))


def _rounded(value: float, std: float) -> float:
    if abs(value) < CERTAIN * std:
        return 0.0
    return simplest(value - std, value + std, value)
