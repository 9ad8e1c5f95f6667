"""The force that would make what a model leaves of the motion, from its smoothed rates."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import RESIDUAL_PARABOLA_SAMPLES
from rthm_analysis.diagnosis.missing.sites import site_of
from rthm_analysis.diagnosis.signals import smoothed
from rthm_core.spec.sections import MATRICES

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.evidence import Evidence
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


def residual_force(
    evidence: Evidence, spec: Spec, predicted: Floats, name: str
) -> tuple[Floats, Floats, Floats] | None:
    """Measured position and velocity at a site, and the force that a model lacks there: (s,) each.

    Parameters
    ----------
    evidence, spec
        The recording, and the model.
    predicted : (s, k) array
        What the model makes of the channels.
    name : str
        Of the site. Between two dofs it is the force whose opposite acts on the other, as their motion
        relative to each other tells it.
    """
    assert spec.plant is not None
    place = site_of(spec, name).place
    here = _of_dof(evidence, spec, predicted, place.dof)
    if here is None or place.other < 0:
        return here
    there = _of_dof(evidence, spec, predicted, place.other)
    if there is None:
        return None
    n = len(spec.plant.dofs)
    mass, beside = np.diag(np.reshape(spec.plant.mass, (n, n)))[list(place)]
    force = (here[2] / mass - there[2] / beside) * mass * beside / (mass + beside)
    return here[0] - there[0], here[1] - there[1], np.asarray(force)


def _of_dof(
    evidence: Evidence, spec: Spec, predicted: Floats, i: int
) -> tuple[Floats, Floats, Floats] | None:
    """The same of a dof, as if it moved alone."""
    assert spec.plant is not None
    dof, n = spec.plant.dofs[i], len(spec.plant.dofs)
    channels = {(c.family, c.place): k for k, c in enumerate(evidence.channels)}
    where = channels.get(("position", dof))
    if where is None or evidence.stamps_ns.size < 10 * RESIDUAL_PARABOLA_SAMPLES:
        return None
    step = float(np.median(np.diff(evidence.time)))
    left = np.nan_to_num(evidence.measured - predicted)
    x = np.nan_to_num(evidence.measured[:, where])
    speed = channels.get(("velocity", dof))
    width = RESIDUAL_PARABOLA_SAMPLES if speed is not None else 4 * RESIDUAL_PARABOLA_SAMPLES + 1
    dx = smoothed(left[:, where], width)
    if speed is not None:
        v, dv = np.nan_to_num(evidence.measured[:, speed]), left[:, speed]
        da = smoothed(dv, width, 1) / step
    else:
        v, dv = smoothed(x, width, 1) / step, smoothed(left[:, where], width, 1) / step
        da = smoothed(left[:, where], width, 2) / step**2
    mass, damping, stiffness = (float(getattr(spec.plant, name)[i * n + i]) for name in MATRICES)
    pull = 0.0
    if spec.interface is not None and spec.actuator is not None and evidence.driven_by == "command":
        pull = sum(k for k, at in zip(spec.k_tot, spec.interface.plant_dof, strict=True) if at == dof)
    return x, v, mass * da + damping * dv + (stiffness + pull) * dx
