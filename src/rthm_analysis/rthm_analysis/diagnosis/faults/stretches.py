"""Stretches of samples: where they are, when that was, and how to leave them out."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rthm_analysis.diagnosis.replay.evidence import Evidence

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers

Flags = np.ndarray[tuple[Any, ...], np.dtype[np.bool_]]
Stretch = tuple[int, int]
"""First sample, and the one after the last."""


def stretches(flags: Flags) -> list[Stretch]:
    """Stretches of samples that are all flagged.

    Examples
    --------
    >>> stretches(np.array([True, True, False, True]))
    [(0, 2), (3, 4)]
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


def pieces(values: Floats) -> tuple[Integers, Integers]:
    """First sample and length of each piece of a signal over which it repeats one value, as bits."""
    begin = np.flatnonzero(np.concatenate([[True], values[1:] != values[:-1]]))
    return begin, np.diff(np.append(begin, values.size))


def interval(evidence: Evidence, stretch: Stretch) -> tuple[float, float]:
    """Seconds since the start of the test of its first and its last sample."""
    return float(evidence.time[stretch[0]]), float(evidence.time[stretch[1] - 1])


def whole_interval(evidence: Evidence, found: list[Stretch]) -> tuple[float, float]:
    """Seconds from the beginning of the first stretch to the end of the last."""
    return interval(evidence, (found[0][0], found[-1][1]))


def flagged(found: list[Stretch], samples: int) -> Flags:
    """Samples that are in one of the stretches."""
    flags = np.zeros(samples, dtype=bool)
    for begin, end in found:
        flags[begin:end] = True
    return flags


def without(evidence: Evidence, column: int, found: list[Stretch]) -> Evidence:
    """Evidence in which one channel is not known over some stretches."""
    measured = evidence.measured.copy()
    measured[flagged(found, measured.shape[0]), column] = np.nan
    return replace(evidence, measured=measured)


def with_column(evidence: Evidence, column: int, values: Floats) -> Evidence:
    """Evidence in which one channel has other values."""
    measured = evidence.measured.copy()
    measured[:, column] = values
    return replace(evidence, measured=measured)


def grain(values: Floats) -> float:
    """Smallest change that is common: the step of a coarse sensor."""
    changes = np.abs(np.diff(values))
    changes = changes[changes > 0.0]
    return float(np.quantile(changes, 0.05)) if changes.size else 0.0


def held_commands(evidence: Evidence) -> Floats:
    """Commands (s, m) as they stand at the samples; nothing before the first."""
    row = np.searchsorted(evidence.due_ns, evidence.stamps_ns, side="right") - 1
    return evidence.commands[np.maximum(row, 0)]
