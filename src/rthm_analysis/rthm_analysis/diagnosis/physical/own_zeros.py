"""Whether zeros differ from recording to recording, and whether those of sensors or of forces do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

from rthm_analysis.diagnosis.criteria.search import DISTINGUISHING_GAIN
from rthm_analysis.diagnosis.criteria.zeros import ZERO_SHARE, ZERO_STDS, ZERO_TIE_SHARE
from rthm_analysis.diagnosis.physical.side import Physical, diagnose_physical
from rthm_analysis.diagnosis.physical.zeros import LOAD, Compared, OwnZeros, Zeros, compared, zeros_of
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_core.compiled import Floats
from rthm_core.spec import Spec

WITH_ZEROS = ("position", "velocity", "force")
"""Families whose zeros may differ; those of accelerometers are taken out anyway."""


class _Run(NamedTuple):
    """A diagnosis behind zeros of sensors or of forces, and zeros that differ beside what it found."""

    physical: Physical
    differing: list[Zeros]
    of_forces: bool

    @property
    def zeros(self) -> Zeros | None:
        """Those that it was made behind, beside what it found; None where they need not differ."""
        return next((one for one in self.differing if one.of_forces == self.of_forces), None)

    def told(self, zeros: Zeros) -> Physical:
        """What it found, with those zeros, and others that the recordings do not tell from them."""
        others = (one for one in self.differing if one is not zeros)
        rival = next((one for one in others if _alike(one, zeros)), None)
        return replace(self.physical, own_zeros=OwnZeros(zeros, rival))


def diagnose_several(
    evidence: Evidence, spec: Spec, before: Floats, progress: Callable[[str], None]
) -> Physical:
    """The physical side behind one recording or several, each with zeros of its own where they differ.

    Parameters are those of `diagnose_physical`. What differs beside a model that lacks physics is asked again
    of the one that was found: zeros of sensors then come before those of forces, and the latter are tried
    where the former are not enough.
    """
    if not evidence.has_several:
        return diagnose_physical(evidence, spec, before, progress)
    first = before if evidence.driven_by == "command" else before[:0]

    def run(zeros: Zeros | None) -> _Run:
        seen = evidence if zeros is None else zeros.taken_from(evidence, spec.plant.dofs)
        physical = diagnose_physical(seen, spec, before, progress)
        beside = differing(evidence, physical.selection.best.model.spec, first)
        return _Run(physical, beside, zeros is not None and zeros.of_forces)

    progress("comparing the zeros of the recordings")
    start = _first_choice(differing(evidence, spec, first))
    begun = run(start)
    tried = [] if start is None else [begun]
    for zeros in begun.differing:
        if not any(one.of_forces == zeros.of_forces or _is_enough(one.zeros) for one in tried):
            progress("looking again behind zeros of each recording")
            tried.append(run(zeros))
    ends = [(one, one.zeros) for one in tried if one.zeros is not None]
    if not ends:
        return begun.physical
    best, found = min(ends, key=lambda end: end[1].left)
    return best.told(found)


def differing(evidence: Evidence, spec: Spec, first: Floats) -> list[Zeros]:
    """Zeros of sensors, and zeros of forces, that differ from recording to recording beside a model; those
    that need not are left out.
    """
    beside = compared(evidence, spec, first)
    sensors = tuple(one for one in evidence.channels if one.family in WITH_ZEROS)
    forces = tuple(Channel(LOAD, dof) for dof in spec.plant.dofs)
    return [one for some in (sensors, forces) if (one := _needed(beside, some)) is not None]


def _first_choice(found: list[Zeros]) -> Zeros | None:
    """Zeros to begin with: of two that do the same the fewer; else those of sensors unless those of forces
    alone are enough, as a model that lacks physics favours either.
    """
    if len(found) < 2:
        return found[0] if found else None
    of_sensors, of_forces = found
    if _alike(of_sensors, of_forces):
        return min(found, key=lambda one: len(one.targets))
    return of_forces if of_forces.are_enough and of_forces.left < of_sensors.left else of_sensors


def _alike(one: Zeros, other: Zeros) -> bool:
    """Whether two leave as much."""
    left = min(one.left, other.left)
    return abs(one.left - other.left) < max(DISTINGUISHING_GAIN, ZERO_TIE_SHARE * (left - one.expected))


def _is_enough(zeros: Zeros | None) -> bool:
    return zeros is not None and zeros.are_enough


def _needed(beside: Compared, targets: tuple[Channel, ...]) -> Zeros | None:
    """Zeros of those signals alone that differ; None where zeros that all recordings share do as well."""
    found = zeros_of(beside, targets)
    while found is not None and _differs(found) and (some := found.differing) != found.targets:
        found = zeros_of(beside, some) if some else None
    return found if found is not None and _differs(found) else None


def _differs(found: Zeros) -> bool:
    """Whether most of what shared zeros leave above the noise is gone with those of each recording."""
    return found.gone > max(ZERO_STDS**2, ZERO_SHARE * (found.shared - found.expected))
