"""The force that a wire has beyond that of a linear spring, drawn over the variable that explains it best."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from rthm_analysis.diagnosis.missing.binned import binned, spread_over
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.result import Curve, Physics
from rthm_core.compiled import Floats


def wire_curve(physical: Physical, physics: Sequence[Physics]) -> Iterator[Curve]:
    """Measured force beyond k (u - x), for each wire with named physics and a force sensor.

    The motor position u is the model's, x and the force are measured. What was named is the force of the
    best model beyond that of its own linear spring.
    """
    spec, evidence = physical.selection.best.model.spec, physical.evidence
    if spec.actuator is None or spec.interface is None or spec.plant is None:
        return
    motion = physical.experiment.motion(spec, physical.windows)
    for actuator, name in enumerate(spec.actuator.names):
        dof, k = spec.interface.plant_dof[actuator], spec.k_tot[actuator]
        if not any(one.block == "wire" and one.place == name for one in physics):
            continue
        force, x = _measured(physical, "force", name), _measured(physical, "position", dof)
        if force is None or x is None:
            continue
        at = spec.plant.dofs.index(dof)
        u = motion.motor[:, actuator]
        rate = np.gradient(u, evidence.time) - motion.velocity[:, at]
        variables = {"u - x": (u - x, "m"), "du/dt - v": (rate, "m/s")}
        known = np.isfinite(force) & np.isfinite(x)
        beyond = (force - k * (u - x))[known]
        named = (motion.force[:, actuator] - k * (u - motion.position[:, at]))[known]
        curves = {variable: binned(values[known], beyond) for variable, (values, _) in variables.items()}
        best = max(curves, key=lambda variable: curves[variable][3])
        over, unit = variables[best]
        law = spread_over(over[known], named)
        yield Curve("wire", best, unit, *curves[best][:3], law, curves[best][3])


def _measured(physical: Physical, family: str, place: str) -> Floats | None:
    for i, channel in enumerate(physical.evidence.channels):
        if (channel.family, channel.place) == (family, place):
            return np.asarray(physical.evidence.measured[:, i])
    return None
