"""Which samples a receiver on a clock held at its ticks, and their values as it got them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rthm_analysis.diagnosis.links.stamps import sent_stamps
from rthm_analysis.recording import Recording, rows_of
from rthm_analysis.timing.links import SOURCES, clock_of, derived_uses, ticks_of
from rthm_core.schedule import Schedule

if TYPE_CHECKING:
    from rthm_core.compiled import Floats, Integers
    from rthm_core.spec import Spec


@dataclass(frozen=True)
class Latched:
    """Samples of the plant in use at the ticks of a receiver.

    Attributes
    ----------
    tick : (n,) array
        Numbers of the ticks whose use is known, ascending.
    motion : (n, 2 m) array
        [x1, v1] at the interface as the sensors showed it; NaN: the sample is not recorded.
    first : int
        First tick with a use; before it the initial motion was held.
    initial : (2 m,) array
        That motion.
    period : int
        Period of the ticks, ns.
    told : bool
        Whether the receiver told its uses; otherwise they are those of the exact schedule.
    """

    tick: Integers
    motion: Floats
    first: int
    initial: Floats
    period: int
    told: bool

    def at(self, numbers: Integers) -> Floats:
        """Motion (k, 2 m) held at ticks of these numbers; NaN: not known."""
        row, known = rows_of(self.tick, numbers)
        held = np.where(known[:, None], self.motion[row], np.nan)
        return np.where((numbers < self.first)[:, None], self.initial, held)


def latched(recording: Recording, spec: Spec, schedule: Schedule, name: str) -> Latched | None:
    """Samples that came over link `name` (``tau1`` or ``tau2``); None: nothing is known of them."""
    source, period = recording.tables[SOURCES[name]], clock_of(name, schedule)[1]
    told = name in recording.links
    uses = recording.links[name] if told else derived_uses(recording, schedule, name)
    if uses is None or not len(uses):
        return None
    stamps = sent_stamps(recording, spec, name, source) if told else uses.sample_ns
    tick = ticks_of(uses.use_ns - recording.start_ns, period)
    known = tick >= 0
    tick, stamps = tick[known], stamps[known]
    dofs = spec.loop().interface.plant_dof
    motion = np.hstack([source.columns(field, dofs) for field in ("position", "velocity")])
    row, there = rows_of(source.stamp_ns, stamps)
    held = np.where(there[:, None], motion[row], np.nan)
    at = [spec.plant.dofs.index(dof) for dof in dofs]
    initial = [spec.plant.initial_position[i] for i in at] + [spec.plant.initial_velocity[i] for i in at]
    return Latched(tick, held, int(tick[0]), np.array(initial, dtype=float), period, told)


def delayed(times: Integers, values: Floats, delay_ns: int, at: Integers) -> Floats:
    """Held signal (n, m) seen `delay_ns` later at the instants `at`; zero before its first value."""
    row = np.searchsorted(times + delay_ns, at, side="right") - 1
    return np.where((row >= 0)[:, None], values[np.maximum(row, 0)], 0.0)
