"""Everything that is wrong with a recording, found and mended in an order in which each step can trust
the last.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rthm_analysis.diagnosis.faults.belonging import find_wrong_spec
from rthm_analysis.diagnosis.faults.bend import NONLINEAR, Bend, straightened
from rthm_analysis.diagnosis.faults.clipped import find_clipped
from rthm_analysis.diagnosis.faults.dead import find_dead
from rthm_analysis.diagnosis.faults.delays import find_delays, moved_back
from rthm_analysis.diagnosis.faults.deviations import Deviation
from rthm_analysis.diagnosis.faults.drift import Drift, find_drift
from rthm_analysis.diagnosis.faults.dropouts import find_dropouts
from rthm_analysis.diagnosis.faults.factors import find_factors
from rthm_analysis.diagnosis.faults.hum import find_hum
from rthm_analysis.diagnosis.faults.known_loads import find_loads, told_by_one
from rthm_analysis.diagnosis.faults.leaks import CROSSTALK
from rthm_analysis.diagnosis.faults.moments import Moment, without_moments
from rthm_analysis.diagnosis.faults.rectified import find_rectified
from rthm_analysis.diagnosis.faults.scaling import FACTORS
from rthm_analysis.diagnosis.faults.several_dofs import find_positions
from rthm_analysis.diagnosis.faults.spikes import find_spikes
from rthm_analysis.diagnosis.faults.stuck import find_stuck
from rthm_analysis.diagnosis.faults.wander import Wander
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_analysis.diagnosis.result import Fault
from rthm_analysis.recording import Recording
from rthm_core.spec import Spec
from rthm_core.topics import PLANT_STATE

CHANGING = (*FACTORS, "swapped", "channel_delay", NONLINEAR, CROSSTALK)
"""Faults that change every sample of a signal."""


@dataclass(frozen=True)
class Mended:
    """A recording as it should have been.

    Attributes
    ----------
    evidence : Evidence
        Corrected; damaged stretches are NaN in `measured`.
    faults : tuple of Fault
        What was wrong.
    notes : tuple of str
        What else is odd about it, one sentence each.
    """

    evidence: Evidence
    faults: tuple[Fault, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def moved(self) -> bool:
        """Whether positions or velocities are others than recorded throughout."""
        sensors = ("sensor.position", "sensor.velocity")
        return any(one.kind in CHANGING and one.block in sensors for one in self.faults)

    def moved_back(self, late: Mapping[Channel, float]) -> Mended:
        """The same with channels that come late by so many seconds."""
        evidence, faults = moved_back(self.evidence, late)
        return replace(self, evidence=evidence, faults=(*self.faults, *faults))

    def without(self, deviation: Drift | Deviation | Wander) -> Mended:
        """The same without what the whole recording deviates by."""
        faults = (*self.faults, deviation.fault(self.evidence))
        return replace(self, evidence=deviation.corrected(self.evidence), faults=faults)

    def without_moments(self, moments: Sequence[Moment]) -> Mended:
        """The same without the moments in which something pushed the plant, or its sensors were off."""
        evidence, faults = without_moments(self.evidence, moments)
        return replace(self, evidence=evidence, faults=(*self.faults, *faults))

    def straightened(self, bends: Mapping[Channel, Bend]) -> Mended:
        """The same without the errors of sensors that are not linear."""
        evidence, faults = straightened(self.evidence, bends)
        return replace(self, evidence=evidence, faults=(*self.faults, *faults))


def with_motion(recording: Recording, evidence: Evidence) -> Recording:
    """The recording with the positions and velocities of its plant as they should have been.

    Parameters
    ----------
    recording : Recording
    evidence : Evidence
        Of it, corrected; what was left out of it stays as recorded.
    """
    plant = recording.plant
    fields: dict[str, Any] = {"position": plant.position.copy(), "velocity": plant.velocity.copy()}
    for column, channel in enumerate(evidence.channels):
        if channel.family in fields:
            values, at = evidence.measured[:, column], plant.names.index(channel.place)
            fields[channel.family][:, at] = np.where(
                np.isfinite(values), values, fields[channel.family][:, at]
            )
    return replace(recording, tables=recording.tables | {PLANT_STATE: replace(plant, **fields)})


def mend(evidence: Evidence, spec: Spec) -> Mended:
    """Find what is wrong with a recording, rather than with the rig, and correct it where that is sure.

    Parameters
    ----------
    evidence : Evidence
        Of a hybrid test, or of a plant under known forces.
    spec : Spec
        The nominal model; stated uncertainties are allowed for.

    Returns
    -------
    Mended
        The same evidence and no faults where nothing is wrong beyond doubt.

    Examples
    --------
    >>> mended = mend(gather(recording, spec), spec)  # doctest: +SKIP
    >>> [fault.kind for fault in mended.faults]  # doctest: +SKIP
    ['sign']
    """
    evidence, faults = find_dead(evidence, spec)
    for find in (find_dropouts, find_stuck, find_clipped, find_spikes):
        evidence, found = find(evidence)
        faults += found
    evidence, found = find_rectified(evidence, spec)
    faults += found
    evidence, found = find_factors(evidence, spec)
    evidence, faults = told_by_one(evidence, [*faults, *found], spec)
    for find_with in (find_loads, find_positions, find_drift, find_delays, find_hum, find_wrong_spec):
        evidence, found = find_with(evidence, spec)
        faults += found
    return Mended(evidence, _without_turned_back(faults))


def _without_turned_back(faults: list[Fault]) -> tuple[Fault, ...]:
    """The same without signals that were turned round or converted, and back again once more was known."""
    factors: dict[tuple[str, str], list[float]] = {}
    for one in faults:
        if one.kind in FACTORS and one.value is not None:
            factors.setdefault((one.block, one.channel), []).append(one.value)
    back = {where for where, by in factors.items() if len(by) > 1 and np.isclose(np.prod(by), 1.0)}
    return tuple(one for one in faults if one.kind not in FACTORS or (one.block, one.channel) not in back)
