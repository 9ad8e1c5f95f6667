"""Where and when something is missing, where nothing was named."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.fitting.wires_alone import WiresAlone
from rthm_analysis.diagnosis.physical.remainder import slow_power
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.replay.model import Model

THROUGHOUT = 0.8
"""Part of a recording over which a mismatch that starts or stops may reach and still have an interval."""

WIRE = 3.0
"""Power of the slow residual of a wire's force along the recorded motion, over the noise, from which the wire
is where something is missing: what the smoothing of that motion leaves is less.
"""


def located_without_names(physical: Physical) -> set[str]:
    """Blocks in which something is missing: the wires whose own force says so, else the plant.

    A wire is right if it is so with the values of the spec or with those of the retuned model, which what is
    missing in the plant may have drawn away.
    """
    alone = physical.fitting.wires_alone
    if not alone.forces:
        return {"plant"}
    models = (physical.nominal.model, physical.choice.base.model)
    return {"wire"} if all(_wires_are_off(alone, model) for model in models) else {"plant"}


def _wires_are_off(alone: WiresAlone, model: Model) -> bool:
    """Whether the force of a wire is not that of a model along the recorded motion."""
    columns = alone.residual(model).reshape(-1, len(alone.forces))
    return any(slow_power(column)[0] > WIRE for column in columns.T)


def when(judged: Judgement) -> tuple[float, float] | None:
    """Interval in s in which the recording differs; None: throughout, or where nobody can tell."""
    physical = judged.physical
    parts = [one.parts for one in judged.left_over if one.parts.size]
    if not parts:
        return None
    rows = np.concatenate(parts)
    begin, end = int(rows[:, 0].min()), int(rows[:, 1].max())
    if end - begin > THROUGHOUT * physical.evidence.time.size:
        return None
    time = physical.evidence.time
    return float(time[begin]), float(time[min(end, time.size - 1)])
