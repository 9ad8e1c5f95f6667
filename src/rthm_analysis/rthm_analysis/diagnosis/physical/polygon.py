"""A free curve over position, velocity or load as a law: straight between a few knots, and beyond them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.missing.curves import CurveFit
from rthm_analysis.diagnosis.replay.model import EffectInstance
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_core.effects.formula import NUMBERS
from rthm_core.effects.written import Formula, Written

if TYPE_CHECKING:
    from rthm_core.compiled import Floats

JUMP = "sign(v)"


def polygon(fit: CurveFit) -> InitialGuess | None:
    """The law of a free curve over motion or load by itself, maybe with a jump at rest; None of any other.

    Its sizes are a value at the first knot, the first slope, and a change of slope at every knot behind it.
    """
    curves = fit.feature.curves
    if not curves or curves[0].carrier != "1" or curves[0].over not in ("x", "v", "load"):
        return None
    if len(curves) > 1 and [one.carrier for one in curves[1:]] != [JUMP]:
        return None
    jump = float(fit.sizes[-1]) if len(curves) > 1 else None
    return polygon_over(
        Formula, fit.site, curves[0].over, curves[0].knots, fit.sizes[: curves[0].knots.size], jump
    )


def polygon_over(
    law: type[Written], place: str, over: str, at: Floats, force: Floats, jump: float | None = None
) -> InitialGuess:
    """The same of a curve over a variable, with its values at some places (k,)."""
    names = NUMBERS[: len(NUMBERS) - (jump is not None)]
    knots = np.quantile(at, np.linspace(0.0, 1.0, len(names)))
    force = np.interp(knots, at, force)
    slopes = np.diff(force) / np.diff(knots)
    first, *bends = (f"{knot:.6g}" for knot in knots[:-1])
    text = f"{names[0]} + {names[1]} * ({over} - {first})".replace("- -", "+ ")
    for name, knot in zip(names[2:], bends, strict=True):
        text += f" + {name} * max({over} - {knot}, 0)".replace("- -", "+ ")
    values = dict(zip(names, (force[0], slopes[0], *np.diff(slopes)), strict=True))
    if jump is not None:
        text, values = f"{text} + {NUMBERS[-1]} * {JUMP}", values | {NUMBERS[-1]: jump}
    size = float(np.abs(force).max())
    scales = dict.fromkeys(values, size / float(np.ptp(knots))) | {names[0]: size, NUMBERS[-1]: size}
    numbers = {name: float(value) for name, value in values.items()}
    added = EffectInstance(law.blocks[0], law.kind, place, {law.text: text, **numbers})
    return InitialGuess(added, tuple(numbers), (NUMBERS[0],), {name: scales[name] for name in numbers})


def is_polygon(text: str) -> bool:
    """Whether a formula is one."""
    return text.count("max(") >= len(NUMBERS) - 3
