"""The plant alone, driven by the forces that its wires were measured to have.

Beside a wire that is no spring, no simulation from the commands comes near the recording before both are
right. But what the plant lacks shows in its motion under the force that was measured, whatever made it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.replay.between import Between
from rthm_analysis.diagnosis.replay.evidence import MOTION, Evidence
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.windows import windows
from rthm_analysis.diagnosis.signals import filled
from rthm_core.compiled import Floats
from rthm_core.spec import Spec

OF_THE_PLANT = ("plant", *(f"sensor.{family}" for family in MOTION))
"""Blocks that a plant alone has."""


def driven_plant(fitting: Fitting, base: Fitted) -> Fitting | None:
    """Fits of the plant alone, in short runs; None where the force of a wire was not measured.

    The noise of that force moves the plant, too: the true model leaves a little more than noise.

    Parameters
    ----------
    fitting : Fitting
    base : Fitted
        Whose values of the plant it has.
    """
    spec, seen = base.model.nominal, fitting.experiment.evidence
    evidence = fitting.experiment.loads or seen  # a draft has few of the samples of a force that jumps
    if spec.actuator is None or spec.interface is None or spec.plant is None:
        return None
    force = _of_wires(evidence, spec)
    kept = [i for i, one in enumerate(evidence.channels) if one.family in MOTION]
    if force is None or not kept:
        return None
    nothing = np.empty(0, dtype=np.int64), np.empty((0, 0))
    alone = replace(
        evidence.only(*MOTION),
        due_ns=nothing[0],
        commands=nothing[1],
        load=evidence.load + force,
        driven_by="force",
    )
    experiment = Experiment(alone, np.empty(0), between=Between.LINEAR, budget=fitting.budget)
    if fitting.experiment.is_draft:
        experiment = experiment.draft(np.searchsorted(evidence.stamps_ns, seen.stamps_ns))
    model = plant_model(base.model)
    runs = windows(experiment.evidence, model.spec, known_start=False, short=True)
    experiment.begin_at(experiment.evidence.stamps_ns[runs.start])
    colours = tuple(fitting.colours[i] for i in kept) if fitting.colours else ()
    return Fitting(
        experiment, runs, fitting.sigma[kept], model, fitting.progress,
        colours=colours, cores=fitting.cores, simple=fitting.simple,
    )  # fmt: skip


def short_runs(fitting: Fitting, model: Model) -> Fitting:
    """Fits of the same recording in runs of one period."""
    evidence = fitting.experiment.evidence
    runs = windows(evidence, model.spec, evidence.driven_by == "command", short=True)
    experiment = fitting.experiment.beginning_at(evidence.stamps_ns[runs.start])
    return Fitting(
        experiment, runs, fitting.sigma, model, fitting.progress,
        colours=fitting.colours, cores=fitting.cores,
    )  # fmt: skip


def plant_model(model: Model) -> Model:
    """A model without its loop, with its values of the plant, and without added effects."""
    spec = model.nominal
    effects = tuple(one for one in spec.effects if one.block in OF_THE_PLANT)
    alone = Spec(plant=spec.plant, effects_from=spec.effects_from, effects=effects)
    own = tuple(one for one in model.parameters if one.key.startswith("plant."))
    return Model(alone, own, prefix=model.prefix)


def _of_wires(evidence: Evidence, spec: Spec) -> Floats | None:
    """Measured forces of all wires on the dofs (s, n), N, straight over what is not known."""
    assert spec.plant is not None and spec.interface is not None and spec.actuator is not None
    total = np.zeros((evidence.stamps_ns.size, len(spec.plant.dofs)))
    measured = {c.place: i for i, c in enumerate(evidence.channels) if c.family == "force"}
    for name, dof in zip(spec.actuator.names, spec.interface.plant_dof, strict=True):
        if name not in measured:
            return None
        values = evidence.measured[:, measured[name]]
        if not np.isfinite(values).any():
            return None
        total[:, spec.plant.dofs.index(dof)] += filled(values)
    return total
