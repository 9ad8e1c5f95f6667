"""Everything that a page shows, computed once."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rthm_analysis.energy import EnergyResult, energy_of
from rthm_analysis.outcome import Outcome, outcome_of
from rthm_analysis.recording import Recording, read_recording
from rthm_analysis.timing import TimingResult, timing_of
from rthm_core.errors import InputError
from rthm_core.events import Abort

if TYPE_CHECKING:
    from rthm_core.engine import Trajectory
    from rthm_core.spec import Spec

ROWS_OF_IDEAL = 4000


@dataclass(frozen=True)
class Gathered:
    """Results about one recording; None where there is nothing to tell, and `notes` say why."""

    recording: Recording
    energy: EnergyResult | None
    timing: TimingResult
    ideal: Trajectory | None
    notes: tuple[str, ...]
    abort: Abort | None = None
    outcome: Outcome | None = None

    @property
    def spec(self) -> Spec | None:
        """The spec in the recording."""
        return self.recording.spec


def gather(bag: Recording | str | Path, abort: Abort | None = None) -> Gathered:
    """Analyse a recording, or the one in a bag; InputError when it cannot be read.

    Parameters
    ----------
    abort : Abort, optional
        What ended the test, where the recording does not tell.
    """
    recording = bag if isinstance(bag, Recording) else read_recording(bag)
    timing = timing_of(recording, recording.spec)
    notes = [*_about_others(recording), *recording.notes, *timing.notes]
    energy, ideal = None, None
    try:
        energy = energy_of(recording, recording.spec)
        notes += energy.notes
        ideal = _ideal(recording, energy)
    except InputError as reason:
        notes.append(str(reason))
    outcome = outcome_of(recording, ideal, energy)
    noted = tuple(dict.fromkeys(notes))
    return Gathered(recording, energy, timing, ideal, noted, recording.abort or abort, outcome)


def _about_others(recording: Recording) -> list[str]:
    """What has to be said about who could take part, and about clocks of other hosts."""
    reach = recording.diagnostics.get(f"{recording.namespace}/recorder", {}).get("reach")
    said = ["The network was open: any host on it could take part in this test."] if reach == "open" else []
    return said + [clock.words(node) for node, clock in recording.clocks.nodes.items()]


def _ideal(recording: Recording, energy: EnergyResult) -> Trajectory | None:
    """Motion of the ideal system from the start of the test, for a recording that has that start."""
    spec = recording.spec
    if (
        spec is None
        or not spec.is_loop
        or spec.timing is None
        or energy.t[0] > 0.0
        or recording.duration <= 0.0
    ):
        return None
    from rthm_core.engine import simulate

    sample = max(spec.timing.td1, recording.duration / ROWS_OF_IDEAL)
    return simulate(spec, recording.duration, sample, "ideal", energies=False)
