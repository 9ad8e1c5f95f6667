"""A force that neither motion nor load foretells: somebody pushed, or pulled, and nobody recorded it."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import FORETOLD_SHARE
from rthm_analysis.diagnosis.missing.binned import binned
from rthm_analysis.diagnosis.missing.curves import CurveFit
from rthm_analysis.diagnosis.missing.residual import residual_force
from rthm_analysis.diagnosis.numbers import bare
from rthm_analysis.diagnosis.physical.driven import wires_are_off
from rthm_analysis.diagnosis.physical.locating import when
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.result import Described


def is_foretold(curve: CurveFit | None) -> bool:
    """Whether a free curve explains most of the mismatch, where it was fitted and on unseen data."""
    return curve is not None and min(curve.share, curve.held_out_share) > FORETOLD_SHARE


def unforeseen(judged: Judgement) -> tuple[Described, ...]:
    """The force over time that would make what is left, where it acts on the plant; it predicts nothing."""
    physical, predicted = judged.physical, judged.runs[judged.told].predicted
    if judged.wrong_sensors or wires_are_off(physical) or not np.isfinite(predicted).all():
        return ()
    left = {c.place: one.rms for c, one in zip(physical.evidence.channels, judged.left_over, strict=True)}
    dofs = physical.settled.plant.dofs if physical.settled.plant else ()
    dof = max(dofs, key=lambda one: left.get(one, 0.0))
    found = residual_force(physical.evidence, physical.settled, predicted, dof)
    if found is None:
        return ()
    force, interval = found[2], when(judged)
    at, mean, std, _ = binned(physical.evidence.time, force)
    size = bare(float(np.quantile(np.abs(force), 0.995)), 2)
    since = f" from {bare(interval[0])} s to {bare(interval[1])} s" if interval else ""
    words = (
        f"A force of up to {size} N is missing at {dof}{since} that neither motion nor load foretells: it "
        "may be a load that nobody recorded, and nothing is predicted with it."
    )
    return (
        Described(
            "plant", dof, ("t",), "neither", False, False, interval, None, {}, 0.0, 0.0, at, mean, std,
            words,
        ),
    )  # fmt: skip
