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
from rthm_analysis.recording import hold

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.evidence import Evidence
    from rthm_core.compiled import Floats

SURELY_NOT_ZERO = 10.0
"""Standard deviations that a number has to be away from zero to be told by the recording."""

ZERO = 3.0
"""Standard deviations below which a start is one at zero."""

BETTER = 0.8
"""Ratio of what two readings of the known forces leave from which the better one is taken."""

JUMPS = 0.1
"""Part of the power of a force's steps that those of an elastic wire may leave."""

BEGINNING_SAMPLES = 8
"""Samples through which the beginning of a motion is drawn."""


def plant_of(
    evidence: Evidence, dofs: tuple[str, ...], wires: dict[str, str], masses: Sequence[float]
) -> tuple[Matrices | None, bool]:
    """Matrices of the plant, and whether a known force drives it.

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
        None where a position or a force is not recorded, or too little moves to tell them. Where no known
        force drives the plant and nothing was weighed, the first mass is 1 kg.
    """
    seen = _seen(evidence, dofs, wires)
    if seen is None:
        return None, False
    motion, force = seen
    driven = bool(np.any(force))
    given: list[float | None] = list(masses) or [None if driven else 1.0, *[None] * (len(dofs) - 1)]
    forces = [force, *(_held(evidence, dofs, wires) if driven else [])]
    sampled, between = (fitted_matrices(motion, one, given) for one in (forces[0], forces[-1]))
    better = np.sum(np.square(between.left)) < BETTER**2 * np.sum(np.square(sampled.left))
    best = between if better else sampled
    return (best if _is_told(best, given) else None), driven


def _is_told(found: Matrices, given: Sequence[float | None]) -> bool:
    """Whether the masses that were not given are certain, and of each dof also something beside its mass."""
    size, std = ({name: np.diag(one) for name, one in of.items()} for of in (found.value, found.std))
    certain = {name: np.abs(size[name]) > SURELY_NOT_ZERO * std[name] for name in size}
    free = np.array([mass is None for mass in given])
    heavy = (size["mass"] > 0.0) & (certain["mass"] | ~free)
    moving = certain["damping"] | certain["stiffness"] | free
    return bool(np.all(heavy & moving))


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
    needed = [("position", dof) for dof in dofs] + [("force", name) for name in wires]
    if smooth is None or any(one not in smooth.values for one in needed):
        return None
    places = [("position", dof) for dof in dofs]
    motion = tuple(
        _apart([of[one] for one in places]) for of in (smooth.seconds, smooth.rates, smooth.values)
    )
    return motion, _forces(smooth, dofs, wires)  # type: ignore[return-value]


def _forces(smooth: Smooth, dofs: tuple[str, ...], wires: dict[str, str]) -> Floats:
    forces = [smooth.values["load", dof].copy() for dof in dofs]
    for actuator, dof in wires.items():
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


def wire_stiffness(evidence: Evidence, dofs: tuple[str, ...], wires: dict[str, str]) -> list[float | None]:
    """The k_tot of each wire, N/m, from the jumps of its force at commands; None where there are none."""
    found: list[float | None] = []
    for k, (actuator, dof) in enumerate(wires.items()):
        force, position = (channel_at(evidence, *at) for at in (("force", actuator), ("position", dof)))
        if force is None or position is None:
            found.append(None)
            continue
        motor = hold(evidence.due_ns, evidence.commands[:, k], evidence.stamps_ns)
        stretched = np.diff(motor - evidence.measured[:, position])
        pulled = np.diff(evidence.measured[:, force])
        known = np.isfinite(stretched) & np.isfinite(pulled)
        known &= evidence.stamps_ns[:-1] >= evidence.due_ns[0]
        jumps, pulled = stretched[known], pulled[known]
        power = float(jumps @ jumps)
        value = float(jumps @ pulled) / power if power else 0.0
        left = float(np.sum(np.square(pulled - value * jumps)))
        found.append(value if value > 0.0 and left < JUMPS * float(pulled @ pulled) else None)
    return found


def beginning(
    evidence: Evidence, dofs: tuple[str, ...], actuators: tuple[str, ...]
) -> tuple[list[float], list[float]]:
    """Position and velocity of every dof at the first sample, from a cubic through the first samples.

    A velocity that is not measured is the slope of the position. Each has the digits that are known of it.
    """
    smooth = smoothed(evidence, dofs, actuators)
    step = float(np.median(np.diff(evidence.time)))
    count = max(BEGINNING_SAMPLES, round(smooth.width / step) if smooth else 0)
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
    if known.sum() < BEGINNING_SAMPLES:
        return None, None
    cubic, covariance = np.polyfit(time[known], values[known], 3, cov=True)
    std = np.sqrt(np.diag(covariance))
    return _rounded(float(cubic[3]), float(std[3])), _rounded(float(cubic[2]), float(std[2]))


def _rounded(value: float, std: float) -> float:
    if abs(value) < ZERO * std:
        return 0.0
    return simplest(value - std, value + std, value)
