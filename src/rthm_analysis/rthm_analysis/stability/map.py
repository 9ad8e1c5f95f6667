"""Stability over two parameters of a spec."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.lifted.commensurate import period_of
from rthm_analysis.lifted.cycle import Cycle
from rthm_analysis.lifted.linear_part import linear_part
from rthm_analysis.lifted.matrices import LinearLoop, linear_loop
from rthm_analysis.lifted.radii import spectral_radii, stacked
from rthm_analysis.stability.rates import growth_rates
from rthm_analysis.sweep.points import SCALE, changed
from rthm_analysis.sweep.ranges import Range
from rthm_core.compiled import Floats

if TYPE_CHECKING:
    from rthm_core.spec import Spec

Progress = Callable[[int], None]


@dataclass(frozen=True)
class StabilityMap:
    """Growth rates over two ranges.

    Attributes
    ----------
    ranges : pair of Range
        What is varied.
    growth_rate : (n, k) array
        1/s, of the linear part; below zero the loop is stable. One row for each value of the first range.
    """

    ranges: tuple[Range, Range]
    growth_rate: Floats

    def as_dict(self) -> dict[str, object]:
        """Entry ``map`` in the JSON of ``rthm stability``."""
        return {
            "keys": [one.key for one in self.ranges],
            "values": [one.values.tolist() for one in self.ranges],
            "growth_rate": self.growth_rate.tolist(),
        }


def stability_map(spec: Spec, ranges: tuple[Range, Range], progress: Progress | None = None) -> StabilityMap:
    """Growth rate of a loop's linear part over two entries of its spec (or ``timing.scale``).

    Loops with the same clocks and delays are done together.

    Raises
    ------
    InputError
        When a key is not known, or a value not allowed.
    """
    if str(spec.loop().actuator.compensator) != "none":
        return StabilityMap(ranges, _one_by_one(spec, ranges, progress))
    parts = _Parts(spec, tuple(one.key for one in ranges))
    groups: dict[int, list[tuple[int, int]]] = {}
    cycles: dict[int, Cycle] = {}
    loops: dict[tuple[int, int], LinearLoop] = {}
    for i, first in enumerate(ranges[0].values):
        for j, second in enumerate(ranges[1].values):
            loops[i, j], cycle = parts.at(float(first), float(second))
            cycles[id(cycle)] = cycle
            groups.setdefault(id(cycle), []).append((i, j))
        if progress:
            progress(i + 1)
    rates = np.empty((ranges[0].values.size, ranges[1].values.size))
    for key, points in groups.items():
        radii = spectral_radii(stacked([loops[point] for point in points]), cycles[key])
        with np.errstate(divide="ignore"):
            rates[tuple(np.array(points).T)] = np.log(radii) / cycles[key].hyperperiod
    return StabilityMap(ranges, rates)


def _one_by_one(spec: Spec, ranges: tuple[Range, Range], progress: Progress | None) -> Floats:
    """Growth rates of loops whose compensators know the clocks and delays."""
    rates = np.empty((ranges[0].values.size, ranges[1].values.size))
    for i, first in enumerate(ranges[0].values):
        for j, second in enumerate(ranges[1].values):
            linear, _ = linear_part(changed(spec, [one.key for one in ranges], [first, second]))
            rates[i, j] = growth_rates(linear_loop(linear), period_of(linear).cycle)[0]
        if progress:
            progress(i + 1)
    return rates


class _Parts:
    """Matrices and cycles of changed specs, each made once: clocks and delays are not in the matrices."""

    def __init__(self, spec: Spec, keys: tuple[str, ...]) -> None:
        self.spec, self.keys = spec, keys
        self.timed = [key.startswith("timing.") for key in keys]
        self.loop = cache(self._loop)
        self.cycle = cache(self._cycle)

    def at(self, *values: float) -> tuple[LinearLoop, Cycle]:
        """Matrices and cycle of one point."""
        return self.loop(self._some(values, timed=False)), self.cycle(self._some(values, timed=True))

    def _some(self, values: tuple[float, ...], *, timed: bool) -> tuple[tuple[str, float], ...]:
        rows = zip(self.keys, values, self.timed, strict=True)
        return tuple((key, value) for key, value, of_time in rows if of_time == timed)

    def _linear(self, values: dict[str, float]) -> Spec:
        return linear_part(changed(self.spec, list(values), list(values.values())))[0]

    def _loop(self, values: tuple[tuple[str, float], ...]) -> LinearLoop:
        return linear_loop(self._linear(dict(values)))

    def _cycle(self, values: tuple[tuple[str, float], ...]) -> Cycle:
        given = dict(values)
        factor = given.pop(SCALE, 1.0)
        # A scaled loop has the same pattern: nothing is rounded.
        return period_of(self._linear(given)).cycle.scaled(factor)
