"""A rig measured: a short run in which its motors move a little, and the spec that follows from it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rthm_bringup.driver.travel import check_travel, safe_travel
from rthm_bringup.run.perform import perform
from rthm_bringup.run.plan import Plan, new_folder
from rthm_core.errors import InputError
from rthm_core.excitation import QUIET_START
from rthm_core.limits import require_limits
from rthm_core.spec import Spec, apply

if TYPE_CHECKING:
    from rthm_analysis.identification import Identified
    from rthm_bringup.run.environment import Network
    from rthm_bringup.run.result import Result


@dataclass(frozen=True)
class Measured:
    """A rig that was measured, or why it was not.

    Attributes
    ----------
    result : Result
        The run.
    travel
        Largest distance of the motors from where they stood, m.
    identified : Identified or None
        What was found; None: the run was ended before its time.
    spec : Path or None
        The spec that was written; None: none was.
    """

    result: Result
    travel: float
    identified: Identified | None = None
    spec: Path | None = None

    @property
    def status(self) -> int:
        """Exit status: that of the run, or 1 where nothing was written."""
        return self.result.status or int(self.spec is None)

    def as_dict(self) -> dict[str, Any]:
        """Keys of the JSON: those of the run, and what was measured."""
        found = self.identified.as_dict() if self.identified else None
        return self.result.as_dict() | {
            "travel": self.travel,
            "measured": found,
            "spec": self.spec and str(self.spec),
        }

    def lines(self) -> list[str]:
        """What is printed."""
        abort, problems = self.result.ending.abort, self.result.problems
        lines = [abort.sentence] if abort else []
        lines += [f"bag:    {self.result.plan.bag}", *(self.identified.lines() if self.identified else [])]
        lines.append(f"spec:   {self.spec}" if self.spec else "No spec was written.")
        return [*lines, *problems]


def measure(
    spec: Spec, network: Network, file: Path, seconds: float, patience: float, travel: float | None
) -> Measured:
    """Move the motors of a rig a little, and write the spec that says what it is.

    It is a run as any other: armed, within all limits, supervised, recorded.

    Parameters
    ----------
    spec
        What is claimed, with the limits of a real machine.
    file
        Where the measured spec is written.
    seconds
        Length of the motion, s.
    patience
        How long to wait for the driver, s.
    travel
        Largest distance of the motors from where they stand, m; None: as the limits allow.

    Raises
    ------
    InputError
        If a limit is missing or would be passed, or the file cannot be written.
    """
    require_limits(spec)
    if not file.absolute().parent.is_dir():
        raise InputError(f"{file.parent} is not a folder; name another place for the measured spec.")
    if travel is None:
        travel = safe_travel(spec, seconds)
    else:
        check_travel(spec, travel, seconds)
    assert spec.limits is not None
    duration = QUIET_START + seconds + (spec.limits.ramp or 0.0)
    quiet = apply(spec, {"load.numerical.kind": "none"})
    plan = Plan(
        quiet,
        new_folder(),
        duration,
        network,
        external=frozenset({"plant"}),
        patience=patience,
        hardware=True,
        excitation=travel,
    )
    result = perform(plan)
    if result.ending.abort or result.ending.reason or result.ending.interrupted or not plan.bag.exists():
        return Measured(result, travel)
    return _identified(spec, Measured(result, travel), file)


def _identified(spec: Spec, run: Measured, file: Path) -> Measured:
    from rthm_analysis.identification import identified
    from rthm_analysis.recording import read_recording

    found = identified(read_recording(run.result.plan.bag), spec)
    if found.wrong:
        return Measured(run.result, run.travel, found)
    file.write_text(found.written(spec), encoding="utf-8")
    return Measured(run.result, run.travel, found, file)
