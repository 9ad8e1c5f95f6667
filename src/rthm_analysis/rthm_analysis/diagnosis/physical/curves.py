"""The force that the retuned model lacks, drawn over the variable that explains it best.

The motion that the best model leaves, smoothed just enough, gives the force that would have made it. With
the force of what was named added, this is what the data say about the named physics, whatever they say.
Averages over many samples at the same abscissa let the noise drown.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rthm_analysis.diagnosis.criteria.missing import DRAWN_CURVE_SHARE
from rthm_analysis.diagnosis.missing.binned import binned, spread_over
from rthm_analysis.diagnosis.missing.residual import residual_force
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.physical.work import law_forces
from rthm_analysis.diagnosis.result import Curve, Physics
from rthm_core.compiled import Floats


def force_curve(physical: Physical, predicted: Floats, physics: Sequence[Physics]) -> Iterator[Curve]:
    """Missing force on each dof over x, v or t, whichever it depends on most; none without a mismatch.

    `predicted` is the prediction of the best model.
    """
    spec = physical.settled
    assert spec.plant is not None
    for dof in spec.plant.dofs:
        found = residual_force(physical.evidence, physical.settled, predicted, dof)
        if found is None:
            continue
        x, v, left = found
        named = named_force(physical, dof, x, v)
        force = left if named is None else left + named
        variables = {"x": (x, "m"), "v": (v, "m/s"), "t": (physical.evidence.time, "s")}
        curves = {name: binned(values, force) for name, (values, _) in variables.items()}
        best = max(curves, key=lambda name: curves[name][3])
        at, mean, std, share = curves[best]
        if share > DRAWN_CURVE_SHARE or any(one.block == "plant" for one in physics):
            over, unit = variables[best]
            law = None if named is None else spread_over(over, named)
            yield Curve("plant", best, unit, at, mean, std, law, share)


def named_force(physical: Physical, dof: str, x: Floats, v: Floats) -> Floats | None:
    """Force (s,) of the effects that were named on a dof, along the measured motion; None without any."""
    model = physical.selection.best.model
    here = [i for i, one in enumerate(model.added) if one.block == "plant" and one.place == dof]
    if not here:
        return None
    evidence, place = physical.evidence, model.spec.plant.dofs.index(dof) if model.spec.plant else 0
    return law_forces(model, here, evidence.time, x, v, evidence.load[:, place])
