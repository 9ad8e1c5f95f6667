"""Energy that the physics that was found put into the moving masses or took out of them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.diagnosis.replay.experiment import Experiment, Motion
from rthm_analysis.diagnosis.replay.windows import Windows
from rthm_core.effects.laws import LOAD, MOST_PARAMETERS, has_inertia
from rthm_core.loads import sinusoid
from rthm_core.physical.laws import place_of, reads_load

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.replay.model import Model
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec
    from rthm_core.spec.schema import EffectSpec


def wire_work(experiment: Experiment, runs: Windows, spec: Spec, without: Spec) -> float:
    """Work over the recording, in J, + introduced, of what wires or motors of `spec` do beyond `without`."""
    motion, bare = experiment.motion(spec, runs), experiment.motion(without, runs)
    force = _on_dofs(spec, motion.force - _linear(without, bare.motor, motion))
    return _work(experiment, force, motion.velocity)


def law_work(experiment: Experiment, runs: Windows, spec: Spec, one: EffectSpec) -> float:
    """Work over the recording, in J, + introduced, of one effect on the plant along the model's motion."""
    assert spec.plant is not None
    motion = experiment.motion(spec, runs)
    place, evidence = place_of(spec, one), experiment.evidence
    x, v = (place.apart(signal) for signal in (motion.position, motion.velocity))
    return _work(experiment, law_force(one, evidence.time, x, v, evidence.load[:, place.dof]), v)


def law_forces(
    model: Model, indices: Iterable[int], time: Floats, x: Floats, v: Floats, load: Floats
) -> Floats:
    """Force (s,) of some of the effects that a model adds to one dof, along a given motion."""
    names = {model.name(index) for index in indices}
    effects = [one for one in model.spec.effects if one.name in names]
    return np.asarray(sum((law_force(one, time, x, v, load) for one in effects), np.zeros(time.size)))


def law_force(one: EffectSpec, time: Floats, x: Floats, v: Floats, load: Floats) -> Floats:
    """Force (s,) of a law of the plant along a given motion; its own states by Heun's method."""
    law: Any = one.law
    p = [*one.ordered, *[0.0] * (MOST_PARAMETERS - len(one.ordered))]
    shape = law.excitation(one.ordered)
    if shape is not None:
        return sinusoid(*shape).force(time)
    z = [*law.initial(float(x[0]), one.ordered)]
    first, second, force = [0.0] * law.states, [0.0] * law.states, np.empty(time.size)
    limits = law.thresholds(one.ordered)
    rows = zip(time.tolist(), x.tolist(), v.tolist(), load.tolist(), strict=True)
    before: tuple[float, float, float, int] | None = None
    reads, heavy = reads_load(law), has_inertia(law)
    rates = np.gradient(v, time) if heavy else v
    for k, (t, here, speed, known) in enumerate(rows):
        if reads:
            p[LOAD] = known
        met = {"position": here, "time": t}.get(law.partition)
        mode = (speed > 0.0) - (speed < 0.0) if met is None else sum(met > limit for limit in limits)
        if before is not None and z:
            t0, x0, v0, mode0 = before
            law.rate(x0, v0, z, t0, p, mode0, first)
            guess = [a + (t - t0) * b for a, b in zip(z, first, strict=True)]
            law.rate(here, speed, guess, t, p, mode, second)
            z = [a + 0.5 * (t - t0) * (b + c) for a, b, c in zip(z, first, second, strict=True)]
        try:
            force[k] = law.force(here, speed, z, t, p, mode)
            if heavy:
                force[k] -= law.inertia(here, speed, z, t, p, mode) * rates[k]
        except (ArithmeticError, ValueError):  # what compiled code makes infinite, or no number
            force[k] = np.nan
        before = (t, here, speed, mode)
    return force


def _work(experiment: Experiment, force: Floats, velocity: Floats) -> float:
    power = force * velocity
    return float(np.trapezoid(power if power.ndim == 1 else power.sum(1), experiment.evidence.time))


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
