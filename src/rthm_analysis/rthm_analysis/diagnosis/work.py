"""Energy that the physics that was found put into the moving masses or took out of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.experiment import Experiment, Motion
from rthm_analysis.diagnosis.windows import Windows

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec


def effect_work(experiment: Experiment, runs: Windows, spec: Spec, without: Spec, block: str) -> float:
    """Work over the recording, in J, + introduced, of what `spec` has beyond `without`.

    Parameters
    ----------
    experiment : Experiment
    runs : Windows
    spec, without : Spec
        They differ in one effect.
    block : str
        Where it is. A sensor does no work itself.
    """
    if block.startswith("sensor"):
        return 0.0
    motion = experiment.motion(spec, runs)
    if block == "plant":
        force = plant_force(spec, experiment, motion)
    else:
        bare = experiment.motion(without, runs)
        force = _on_dofs(spec, motion.force - _linear(without, bare.motor, motion))
    power = np.sum(force * motion.velocity, axis=1)
    return float(np.trapezoid(power, experiment.evidence.time))


def plant_force(spec: Spec, experiment: Experiment, motion: Motion) -> Floats:
    """Force on the dofs that mass, damping, stiffness, wires and known loads leave over: (s, n)."""
    assert spec.plant is not None
    n = len(spec.plant.dofs)
    mass, damping, stiffness = (
        np.reshape(getattr(spec.plant, name), (n, n)) for name in ("mass", "damping", "stiffness")
    )
    inertia = motion.acceleration @ mass.T + motion.velocity @ damping.T + motion.position @ stiffness.T
    return np.asarray(inertia - _on_dofs(spec, motion.force) - experiment.evidence.load)


def _on_dofs(spec: Spec, force: Floats) -> Floats:
    """Wire forces (s, m) as forces on the dofs (s, n)."""
    assert spec.plant is not None
    total = np.zeros((force.shape[0], len(spec.plant.dofs)))
    if spec.interface is not None:
        for actuator in range(force.shape[1]):
            total[:, spec.plant.dofs.index(spec.interface.plant_dof[actuator])] += force[:, actuator]
    return total


def _linear(spec: Spec, motor: Floats, motion: Motion) -> Floats:
    """Forces of linear massless wires between motor positions and the dofs: (s, m)."""
    assert spec.plant is not None and spec.interface is not None
    at = [spec.plant.dofs.index(dof) for dof in spec.interface.plant_dof]
    return np.asarray((motor - motion.position[:, at]) * np.array(spec.k_tot))
