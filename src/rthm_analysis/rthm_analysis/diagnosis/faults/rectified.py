"""Sensors that lose the sign: magnitudes, which another channel of the same motion gives their signs back."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.samples import (
    FEWEST_KNOWN_SHARE,
    RECTIFIED_FEWEST_TURNS,
    RECTIFIED_LEFT_SHARE,
    RECTIFIED_NEAR_ZERO_SHARE,
    RECTIFIED_NEAR_ZERO_STDS,
)
from rthm_analysis.diagnosis.faults.naming import fault_of, in_words
from rthm_analysis.diagnosis.faults.plant import plant_seen
from rthm_analysis.diagnosis.faults.relations import Name, relations, wires_of
from rthm_analysis.diagnosis.faults.smooth import channel_at, smoothed
from rthm_analysis.diagnosis.faults.stretches import (
    Stretch,
    held_commands,
    stretches,
    with_column,
)
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.replay.readings import noise_level
from rthm_analysis.diagnosis.result import Fault
from rthm_analysis.diagnosis.signals import filled

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec

RECTIFIED = "rectified"

KINEMATIC = {"position": "velocity", "velocity": "position"}
"""Family that tells the sign of another."""


def find_rectified(evidence: Evidence, spec: Spec) -> tuple[Evidence, list[Fault]]:
    """Give signals that are recorded as magnitudes their signs back, and tell them.

    Only where all relations to other channels then hold: a motion that bounces off a stop stays on one side
    of it, too.
    """
    faults = []
    for column, channel in enumerate(evidence.channels):
        values, name = evidence.measured[:, column], (channel.family, channel.place)
        tried = list(_signs(evidence, spec, column)) if _is_magnitude(values) else []
        before = _open_shares(evidence, spec, name) if tried else []
        every = (with_column(evidence, column, values * signs) for signs in tried)
        turned = next((one for one in every if _agree(_open_shares(one, spec, name), before)), None)
        if turned is not None:
            evidence = turned
            words = (
                f"{in_words(channel, first=True)} is recorded without its sign: it never changes sides, "
                "and agrees with the rest once it is turned round between its zeros. So it was turned for "
                "this diagnosis, and left out next to zero; record the sign, too."
            )
            faults.append(fault_of(channel, RECTIFIED, words))
    return evidence, faults


def _agree(now: list[float], before: list[float]) -> bool:
    """Whether every relation of a signal to others leaves next to nothing open now."""
    better = [after < RECTIFIED_LEFT_SHARE * once for after, once in zip(now, before, strict=False)]
    return bool(better) and all(better)


def _open_shares(evidence: Evidence, spec: Spec, name: Name) -> list[float]:
    """Share of the variance that each relation of a signal to others leaves open; without another signal,
    the known force is what the motion of a plant of any mass, damping and stiffness needs.
    """
    assert spec.plant is not None
    whole = replace(evidence, measured=np.apply_along_axis(filled, 0, evidence.measured))
    smooth = smoothed(whole, spec.plant.dofs, spec.actuator.names if spec.actuator else ())
    if smooth is None:
        return []
    found = [one for one in relations(smooth, spec.plant.dofs, wires_of(spec)) if name in one.signals]
    if found:
        return [1.0 - one.correlation**2 if one.holds else 1.0 for one in found]
    seen = plant_seen(smooth, spec)
    return [1.0 - seen.correlation**2 if min(seen.told, default=0.0) > 0.0 else 1.0] if seen else []


def _is_magnitude(values: Floats) -> bool:
    """Whether a signal never changes sides."""
    known = values[np.isfinite(values)]
    if known.size < FEWEST_KNOWN_SHARE * values.size or not np.ptp(known) > 0.0:
        return False
    return bool(known.min() >= 0.0 or known.max() <= 0.0)


def _signs(evidence: Evidence, spec: Spec, column: int) -> Iterator[Floats]:
    """Signs (s,) that a signal may have had, NaN next to zero: as its partner has them over each stretch
    between two zeros, or, where it has none, another one after each zero.
    """
    size = np.abs(evidence.measured[:, column])
    near = _near_zero(size)
    clear = [(a, b) for a, b in stretches(size > near) if size[a:b].max() > 2.0 * near]
    if len(clear) <= RECTIFIED_FEWEST_TURNS:
        return
    pair = _partner(evidence, spec, column)
    if pair is None:
        turns = np.cumprod(np.full(len(clear), -1.0))
        yield from (_over(clear, sign * turns, size.size) for sign in (-1.0, 1.0))
    else:
        one, other = pair
        told = np.sign([np.sum(one[a:b] * other[a:b]) for a, b in clear])
        if np.count_nonzero(np.diff(told)) >= RECTIFIED_FEWEST_TURNS:
            yield _over(clear, told, size.size)


def _over(found: list[Stretch], values: Floats, samples: int) -> Floats:
    over = np.full(samples, np.nan)
    for (begin, end), value in zip(found, values, strict=True):
        over[begin:end] = value
    return over


def _near_zero(values: Floats) -> float:
    """Size of a reading below which noise may have turned it."""
    noise = noise_level(values, values)
    size = float(np.sqrt(np.nanmean(np.square(values))))
    return max(RECTIFIED_NEAR_ZERO_STDS * noise, RECTIFIED_NEAR_ZERO_SHARE * size)


def _partner(evidence: Evidence, spec: Spec, column: int) -> tuple[Floats, Floats] | None:
    """Two signals that have one sign wherever a channel has the right one; None where nothing tells it."""
    channel = evidence.channels[column]
    values = filled(evidence.measured[:, column])
    if channel.family in KINEMATIC:
        partner = channel_at(evidence, KINEMATIC[channel.family], channel.place)
        if partner is None:
            return None
        other = filled(evidence.measured[:, partner])
        is_position = channel.family == "position"
        return np.gradient(values if is_position else other), other if is_position else values
    wires = wires_of(spec)
    at = next((i for i, one in enumerate(wires) if one.actuator == channel.place), None)
    if at is None or evidence.driven_by != "command":
        return None
    motor = channel_at(evidence, "motor", channel.place)
    drive = held_commands(evidence)[:, at]
    if channel.family == "motor":
        return values, drive
    position = channel_at(evidence, "position", wires[at].dof)
    if position is None:
        return None
    drive = drive if motor is None else filled(evidence.measured[:, motor])
    return values, drive - filled(evidence.measured[:, position])
