"""What pushed a plant for a moment: the force that makes what a model leaves behind its beginning."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.missing.residual import residual_force
from rthm_analysis.diagnosis.numbers import bare
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_analysis.diagnosis.result import Described
from rthm_core.compiled import Floats

LEFT_OUT = (
    "Before and behind what pushed the plant one model follows the recording: it was left out, and the "
    "motion behind it begins anew. Find what it was, or record it as a load."
)


def push_of(physical: Physical, runs: Windows, values: Floats, span: tuple[float, float]) -> Described:
    """The force on the dof that was pushed most, from begin to end (s) of a moment.

    Parameters
    ----------
    physical : Physical
    runs : Windows
        Free runs, of which none begins in the moment, or before the motion behind it is known.
    values : (p,) array
        Of the retuned model.
    span : (float, float)
    """
    evidence, spec = physical.evidence, physical.selection.base.model.at(values).spec
    assert spec.plant is not None
    experiment = physical.experiment.beginning_at(evidence.stamps_ns[runs.start])
    predicted = experiment.predicted(spec, runs)
    inside = (evidence.time >= span[0]) & (evidence.time < span[1])
    time = evidence.time[inside]
    forces = {
        dof: found[2][inside]
        for dof in spec.plant.dofs
        if (found := residual_force(evidence, spec, predicted, dof)) is not None
    }
    dof = max(forces, key=lambda one: float(np.abs(forces[one]).max(initial=0.0)), default=spec.plant.dofs[0])
    force = forces.get(dof, np.zeros(time.size))
    return Described(
        "plant", dof, ("t",), "neither", False, False, span, None, {}, 0.0, 0.0, time, force,
        np.full(time.size, np.nan), _words(dof, span, time, force),
    )  # fmt: skip


def _words(dof: str, span: tuple[float, float], time: Floats, force: Floats) -> str:
    size = ""
    if np.any(force):
        most, blow = float(np.abs(force).max()), float(np.trapezoid(force, time))
        size = f", with up to {bare(most, 2)} N and {bare(blow, 2)} N s in all"
    between = f"Between {bare(span[0], 4)} s and {bare(span[1], 4)} s"
    return f"{between} something that nobody recorded pushed {dof}{size}."
