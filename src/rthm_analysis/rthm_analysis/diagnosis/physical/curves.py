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
from rthm_core.spec.effect import place_keys


def force_curve(physical: Physical, predicted: Floats, physics: Sequence[Physics]) -> Iterator[Curve]:
    """Missing force on each dof, and between two where physics was named there, over x, v or t, whichever it
    depends on most; none without a mismatch.

    `predicted` is the prediction of the best model.
    """
    spec = physical.settled
    assert spec.plant is not None
    between = {one.place for one in physics if one.block == "plant" and one.place not in spec.plant.dofs}
    for place in (*spec.plant.dofs, *sorted(filter(None, between))):
        found = residual_force(physical.evidence, spec, predicted, place)
        if found is None:
            continue
        x, v, left = found
        named = named_force(physical, place, x, v)
        force = left if named is None else left + named
        position, velocity = _names(place)
        variables = {position: (x, "m"), velocity: (v, "m/s"), "t": (physical.evidence.time, "s")}
        curves = {name: binned(values, force) for name, (values, _) in variables.items()}
        best = max(curves, key=lambda name: curves[name][3])
        at, mean, std, share = curves[best]
        if share > DRAWN_CURVE_SHARE or any(one.block == "plant" for one in physics):
            over, unit = variables[best]
            law = None if named is None else spread_over(over, named)
            yield Curve("plant", best, unit, at, mean, std, law, share)


def _names(place: str) -> tuple[str, str]:
    """Position and velocity at a place, as they are called."""
    dof, other = place_keys(place)
    return ("x", "v") if other is None else (f"{dof} - {other}", f"d({dof} - {other})/dt")


def named_force(physical: Physical, place: str, x: Floats, v: Floats) -> Floats | None:
    """Force (s,) of the effects that were named at a place, along the measured motion; None without any."""
    model = physical.selection.best.model
    here = [i for i, one in enumerate(model.added) if one.block == "plant" and one.place == place]
    if not here:
        return None
    evidence, dofs = physical.evidence, model.spec.plant.dofs if model.spec.plant else ()
    load = evidence.load[:, dofs.index(place_keys(place)[0])]
    return law_forces(model, here, evidence.time, x, v, load)
