"""The force that a wire has beyond that of a linear spring, over the variable that explains it best."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rthm_analysis.diagnosis.criteria.missing import FORETOLD_SHARE
from rthm_analysis.diagnosis.missing.binned import binned, spread_over
from rthm_analysis.diagnosis.missing.describe import symmetry_of
from rthm_analysis.diagnosis.numbers import bare, percent
from rthm_analysis.diagnosis.result import Curve, Described, Physics
from rthm_core.compiled import Floats

if TYPE_CHECKING:
    from rthm_analysis.diagnosis.physical.side import Physical
    from rthm_analysis.diagnosis.replay.experiment import Experiment
    from rthm_analysis.diagnosis.replay.windows import Windows
    from rthm_core.spec import Spec

ELONGATION, RATE = "u - x", "du/dt - v"
UNITS = {ELONGATION: "m", RATE: "m/s"}


class Beyond(NamedTuple):
    """What a wire does beyond a linear spring.

    Attributes
    ----------
    name : str
        Of the actuator.
    force, named : (s,) arrays
        Measured force beyond k (u - x), with the motor's position u that the model gives, and that of the
        best model, N.
    variables : dict of (s,) arrays
        Elongation and its rate.
    noise : float
        Standard deviation of `force` by the sensors alone, N.
    """

    name: str
    force: Floats
    named: Floats
    variables: dict[str, Floats]
    noise: float

    def of_elongation(self, samples: int) -> tuple[Floats, Floats]:
        """Elongation and force where both are known, in the first of all samples."""
        known = np.isfinite(self.force[:samples])
        return self.variables[ELONGATION][:samples][known], self.force[:samples][known]


def wire_curve(physical: Physical, physics: Sequence[Physics]) -> Iterator[Curve]:
    """Measured force beyond k (u - x), for each wire with named physics and a force sensor."""
    named = {one.place for one in physics if one.block == "wire"}
    for one in beyond_springs(physical):
        if one.name not in named:
            continue
        known = np.isfinite(one.force)
        curves = {name: binned(over[known], one.force[known]) for name, over in one.variables.items()}
        best = max(curves, key=lambda name: curves[name][3])
        law = spread_over(one.variables[best][known], one.named[known])
        yield Curve("wire", best, UNITS[best], *curves[best][:3], law, curves[best][3])


def wires_described(physical: Physical) -> Iterator[Described]:
    """Wires whose force is a curve of the elongation, which unseen data do not deny; it is in no model."""
    for one in beyond_springs(physical):
        explained = foretold_share(one, physical.train)
        if explained is None:
            continue
        at, force, std, _ = binned(*one.of_elongation(physical.train))
        over, _ = one.of_elongation(one.force.size)
        low, high = float(over.min()), float(over.max())
        words = (
            f"The wire of {one.name} is no linear spring: its force has up to "
            f"{bare(float(np.abs(force).max()), 2)} N beside it that depend on its elongation (seen from "
            f"{bare(low)} to {bare(high)} m). As a curve over it this explains {percent(explained)} of what "
            "is left of the force; no kind of the library fits it."
        )
        yield Described(
            "wire", one.name, ("x", "u"), symmetry_of(at, force), False, False, None, None,
            {ELONGATION: (low, high)}, explained, 0.0, at, force, std, words,
        )  # fmt: skip


def foretold_share(one: Beyond, train: int) -> float | None:
    """Part of a wire's force beyond a spring that a curve over its elongation explains, where that is fitted;
    None where it explains too little there or on unseen data.
    """
    over, known = one.variables[ELONGATION], np.isfinite(one.force)
    seen = known & (np.arange(known.size) < train)
    if not seen.any():
        return None
    at, force, _, _ = binned(over[seen], one.force[seen])
    shares = [_share(one, over, at, force, part) for part in (seen, known & ~seen)]
    told = [share for share in shares if share is not None]
    return shares[0] or 0.0 if told and min(told) >= FORETOLD_SHARE else None


def _share(one: Beyond, over: Floats, at: Floats, force: Floats, part: np.ndarray) -> float | None:
    """Part of the force beyond the spring and the noise that a curve explains; None where there is none."""
    left = one.force[part] - np.interp(over[part], at, force)
    before, after = (float(np.mean(np.square(each))) - one.noise**2 for each in (one.force[part], left))
    return 1.0 - max(after, 0.0) / before if before > one.noise**2 else None


def beyond_springs(physical: Physical) -> Iterator[Beyond]:
    """What each wire with a force sensor does beyond a linear spring, beside the best model."""
    spec = physical.selection.best.model.spec
    return beyond(physical.experiment, physical.windows, spec, physical.noise.level)


def beyond(experiment: Experiment, windows: Windows, spec: Spec, level: Floats) -> Iterator[Beyond]:
    """What each wire with a force sensor does beyond a linear spring, beside a spec; noise levels (k,)."""
    evidence = experiment.evidence
    if spec.actuator is None or spec.interface is None or spec.plant is None:
        return
    motion = experiment.motion(spec, windows)
    channels = [(channel.family, channel.place) for channel in evidence.channels]
    for actuator, name in enumerate(spec.actuator.names):
        dof, k = spec.interface.plant_dof[actuator], spec.k_tot[actuator]
        if ("force", name) not in channels or ("position", dof) not in channels:
            continue
        force, x = (channels.index(one) for one in (("force", name), ("position", dof)))
        at, u = spec.plant.dofs.index(dof), motion.motor[:, actuator]
        elongation = u - evidence.measured[:, x]
        rate = evidence.rates(u) - motion.velocity[:, at]
        yield Beyond(
            name,
            evidence.measured[:, force] - k * elongation,
            motion.force[:, actuator] - k * (u - motion.position[:, at]),
            {ELONGATION: elongation, RATE: rate},
            float(np.hypot(level[force], k * level[x])),
        )
