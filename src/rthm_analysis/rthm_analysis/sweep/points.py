"""Which loops a sweep runs: all combinations of some values, or random draws between their ends."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.sweep.ranges import Range
from rthm_core.compiled import Floats, Integers
from rthm_core.errors import InputError, RefusedError
from rthm_core.kept import RESULTS_KEPT
from rthm_core.spec import apply, number_at, with_timing

if TYPE_CHECKING:
    from rthm_core.spec import Spec

SCALE = "timing.scale"
"""Key beside those of the spec: a factor on all periods and delays."""

MOST_LOOPS = 10_000_000


def grid(ranges: Sequence[Range]) -> Floats:
    """All combinations (N, K) of the values, the last key changing fastest."""
    count = float(np.prod([float(one.values.size) for one in ranges]))
    if count > MOST_LOOPS:
        raise InputError(
            f"the grid has {count:.3g} loops, but at most {MOST_LOOPS} are allowed; make it coarser."
        )
    axes = np.meshgrid(*(one.values for one in ranges), indexing="ij")
    return np.stack([axis.ravel() for axis in axes], axis=1)


def draws(ranges: Sequence[Range], count: int, seed: int) -> Floats:
    """Random values (N, K), even between the ends of each range (in the logarithm for ``log``)."""
    if not 1 <= count <= MOST_LOOPS:
        raise InputError(f"draw is {count}, but must be from 1 to {MOST_LOOPS} loops; correct it.")
    even = np.random.default_rng(seed).uniform(size=(count, len(ranges)))
    columns = [
        one.begin * (one.end / one.begin) ** even[:, k]
        if one.log
        else one.begin + (one.end - one.begin) * even[:, k]
        for k, one in enumerate(ranges)
    ]
    return np.stack(columns, axis=1)


def changed(spec: Spec, keys: Sequence[str], values: Sequence[float]) -> Spec:
    """The spec with the values of one loop.

    Raises
    ------
    InputError
        If a key is not known or a value not allowed.
    """
    changes = dict(zip(keys, (float(value) for value in values), strict=True))
    factor = changes.pop(SCALE, None)
    spec = apply(spec, changes) if changes else spec
    return spec if factor is None else spec.scaled_timing(factor)


class Points:
    """Specs of the loops of a sweep.

    Loops that differ in ``timing`` alone share all other sections, and those with the same timing share that,
    so that what follows from either is computed once (`rthm_core.kept`).
    """

    def __init__(self, spec: Spec, keys: Sequence[str]) -> None:
        self.spec, self.keys = spec, tuple(keys)
        self._part = lru_cache(RESULTS_KEPT)(self._changed)

    def at(self, values: Sequence[float]) -> Spec:
        """Spec of one loop, as `changed` gives it."""
        pairs = list(zip(self.keys, values, strict=True))
        timed, others = (tuple(pair for pair in pairs if _of_time(pair[0]) == of) for of in (True, False))
        try:
            return with_timing(self._part(others), self._part(timed)) if timed else self._part(others)
        except (InputError, RefusedError):
            return changed(self.spec, self.keys, values)  # a part may be refused where the whole is not

    def _changed(self, pairs: tuple[tuple[str, float], ...]) -> Spec:
        return changed(self.spec, [key for key, _ in pairs], [value for _, value in pairs])


def sharing_order(keys: Sequence[str], values: Floats) -> Integers:
    """Order (N,) of loops (N, K) in which those with much in common follow each other: so many different
    timings as results are kept of, each with all that the other keys are.
    """
    timed = np.array([_of_time(key) for key in keys])
    timings, others = _numbered(values[:, timed]), _numbered(values[:, ~timed])
    return np.lexsort([timings, others, timings // (RESULTS_KEPT // 2)])


def _of_time(key: str) -> bool:
    return key.startswith("timing.")


def _numbered(values: Floats) -> Integers:
    """Number (N,) of each of some rows (N, K); equal rows have the same."""
    if values.shape[1] == 0:
        return np.zeros(values.shape[0], dtype=np.int64)
    return np.asarray(np.unique(values, axis=0, return_inverse=True)[1].ravel())


def value_of(spec: Spec, key: str) -> float | None:
    """Value that the spec itself has; None for what is no single number."""
    if key == SCALE:
        return 1.0
    return number_at(spec, key)


def check_ends(spec: Spec, ranges: Sequence[Range]) -> None:
    """Refuse a sweep whose ranges have ends that the spec does not allow, before it starts."""
    keys = [one.key for one in ranges]
    for key in keys:
        if keys.count(key) > 1:
            raise InputError(f"{key} is given {keys.count(key)} times, but must be given once; remove one.")
    for ends in ("begin", "end"):
        changed(spec, keys, [getattr(one, ends) for one in ranges])
