"""A position or a velocity that reads too much or too little: one is not the rate of the other, and the known
force says which, whatever else is missing.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.signals import (
    GAIN_DECIDED_SHARE,
    GAIN_LARGEST_CHANGE,
    GAIN_LEAST_CHANGE,
    GAIN_STRETCHES,
    GAIN_UNRELATED_SHARE,
    GAIN_UNSURE_STDS,
    SMOOTH_POINTS_PER_WIDTH,
)
from rthm_analysis.diagnosis.faults.relations import kinematic
from rthm_analysis.diagnosis.faults.smooth import Smooth, smoothed
from rthm_analysis.diagnosis.faults.stretches import with_column
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_core.substructure import Substructure, substructure

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


class SensorGain(NamedTuple):
    """What a sensor reads over the true value, with its standard deviation.

    Attributes
    ----------
    channel : Channel
    factor, std : float
    instead : Channel or None
        The sensor that may as well read the inverse, as mass and stiffness are too uncertain to say which.
    """

    channel: Channel
    factor: float
    std: float
    instead: Channel | None = None

    def corrected(self, evidence: Evidence) -> Evidence:
        """A recording with the true values."""
        column = evidence.channels.index(self.channel)
        return with_column(evidence, column, evidence.measured[:, column] / self.factor)


def find_gains(evidence: Evidence, spec: Spec) -> list[SensorGain]:
    """Sensors of positions or velocities that read too much or too little, in a plant under known forces.

    Only where the two differ by a factor and nothing else, and the known force goes with the one and not with
    the other, or with the one more where mass and stiffness are too uncertain for that.
    """
    plant = spec.plant
    if plant is None or evidence.driven_by != "force" or len(evidence.recordings) > 1:
        return []
    if {Channel("position", dof) for dof in plant.dofs} - {*evidence.channels}:
        return []
    smooth = smoothed(evidence, plant.dofs, ())
    if smooth is None:
        return []
    unsure = max(spec.uncertainty.plant.mass, spec.uncertainty.plant.stiffness)
    return list(_found(smooth, substructure(plant), plant.dofs, unsure))


def _found(smooth: Smooth, plant: Substructure, dofs: tuple[str, ...], unsure: float) -> Iterator[SensorGain]:
    for place, dof in enumerate(dofs):
        relation = kinematic(smooth, dof)
        if relation is None:
            continue
        ratio, unrelated = relation.gain, 1.0 - relation.correlation**2
        change = ratio - 1.0
        if not GAIN_LEAST_CHANGE < abs(change) < GAIN_LARGEST_CHANGE:
            continue
        if unrelated > GAIN_UNRELATED_SHARE * change**2:
            continue
        force = smooth.values["load", dof]
        part = part_of_force(force, _asked(smooth, plant, dofs, place), smooth.values["velocity", dof])
        if part is None:
            continue
        alike = 2.0 * np.sqrt(np.pi) * SMOOTH_POINTS_PER_WIDTH  # neighbours in a bell have the same noise
        std = ratio * float(np.sqrt(alike * max(unrelated, 0.0) / smooth.rows.size))
        position = SensorGain(Channel("position", dof), 1.0 / ratio, std / ratio**2)
        velocity = SensorGain(Channel("velocity", dof), ratio, std)
        off = {position: abs(part - ratio), velocity: abs(part - 1.0)}
        near, far = sorted(off, key=lambda one: off[one])
        if unsure > GAIN_DECIDED_SHARE * abs(change):
            if off[near] < abs(change) + GAIN_UNSURE_STDS * unsure:
                yield near._replace(instead=far.channel)
        elif off[near] < GAIN_DECIDED_SHARE * abs(change):
            yield near


def _asked(smooth: Smooth, plant: Substructure, dofs: tuple[str, ...], place: int) -> Floats:
    """Force (p,) that a dof asks for by the recorded positions."""
    at = [("position", dof) for dof in dofs]
    rows = (
        (plant.mass[place], smooth.seconds),
        (plant.damping[place], smooth.rates),
        (plant.stiffness[place], smooth.values),
    )
    return np.asarray(
        sum(float(size) * known[one] for row, known in rows for size, one in zip(row, at, strict=True))
    )


def part_of_force(force: Floats, asked: Floats, velocity: Floats) -> float | None:
    """The factor with which a force (p,) goes with one that is asked for (p,), beside any friction and drag
    that differ from stretch to stretch; None where the stretches do not agree.
    """
    parts = []
    for some in np.array_split(np.arange(force.size), GAIN_STRETCHES):
        v = velocity[some]
        columns = np.column_stack([asked[some], v, np.sign(v), np.ones(some.size)])
        parts.append(float(np.linalg.lstsq(columns, force[some], rcond=None)[0][0]))
    middle, spread = float(np.median(parts)), float(np.std(parts))
    return middle if spread < GAIN_DECIDED_SHARE * abs(middle) else None
