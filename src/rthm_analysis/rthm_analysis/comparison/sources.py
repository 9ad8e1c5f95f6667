"""From a recording, a trajectory or a spec to its motion, all by the same names."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rthm_analysis.comparison.motion import Motion
from rthm_analysis.comparison.recorded import motion_of_recording
from rthm_analysis.comparison.simulated import (
    Names,
    motion_of_columns,
    motion_of_spec,
    names_of,
    read_trajectory,
)
from rthm_analysis.recording import read_recording, with_spec
from rthm_core.errors import InputError, printable
from rthm_core.spec import shipped_names, spec_at

if TYPE_CHECKING:
    from rthm_core.compiled import Floats
    from rthm_core.spec import Spec

UNSAID = 20.0
"""Length of a comparison of nothing but specs, s."""

LONGEST_SIMULATION = 3600.0
"""Longest simulation of a spec, s: all of it is in memory."""

RECORDINGS, SPECS = (".mcap", ".db3", ".zstd"), (".yaml", ".yml")

FORMS = (
    "a recording (its folder, .mcap or .db3), the folder of a run, a trajectory (.npz, of rthm simulate) or "
    "a spec (.yaml, or the name of a shipped one)"
)


def motions_at(
    places: Sequence[str], duration: float | None = None, given: Spec | str | None = None
) -> list[Motion]:
    """Motions of several sources.

    A spec is simulated for as long as the longest other source lasts. What has no spec of its own takes the
    names of dofs and actuators from the first source that has one.

    Parameters
    ----------
    places : sequence of str
        Recordings, folders of runs, trajectories, specs.
    duration : float, optional
        Length of the simulations, s.
    given : Spec or str, optional
        Spec of the recordings, whatever their own is.

    Raises
    ------
    InputError
        A place is none of these, or cannot be read.
    """
    kinds = {place: _kind(place) for place in places}
    specs = {place: spec_at(place) for place in places if kinds[place] == "simulation"}
    columns = {place: read_trajectory(Path(place)) for place in places if kinds[place] == "trajectory"}
    recorded = [place for place in places if kinds[place] == "recording"]
    bags = {place: with_spec(read_recording(bag_at(place)), given) for place in recorded}
    known = specs | {place: bag.spec for place, bag in bags.items() if bag.spec is not None}
    first = next((known[place] for place in places if place in known), None)
    found = {place: motion_of_recording(place, bag, first) for place, bag in bags.items()}
    found |= {place: _trajectory(place, columns[place], first) for place in columns}
    others = max((motion.duration for motion in found.values()), default=UNSAID)
    length = others if duration is None else duration
    if specs and not 0.0 < length <= LONGEST_SIMULATION:
        raise InputError(
            f"{next(iter(specs))} would be simulated for {length:g} s, but can be for more than 0 and at "
            f"most {LONGEST_SIMULATION:g} s; give another --duration, or a trajectory of rthm simulate with "
            "--sample."
        )
    found |= {place: motion_of_spec(place, spec, length) for place, spec in specs.items()}
    return [found[place] for place in places]


def bag_at(place: str | Path) -> Path:
    """Where a recording is: the bag in the folder of a run, else the place itself."""
    inside = Path(place) / "bag"
    return inside if inside.is_dir() else Path(place)


def _kind(place: str) -> str:
    path = Path(place)
    if path.is_dir():
        return "recording"
    if path.is_file():
        kinds = {".npz": "trajectory", **dict.fromkeys(RECORDINGS, "recording")}
        kind = (kinds | dict.fromkeys(SPECS, "simulation")).get(path.suffix)
        if kind is None:
            raise InputError(
                f"{printable(place)} is none of the files that can be compared; give {FORMS} (rthm import"
                " makes a recording of CSV, MAT or Parquet)."
            )
        return kind
    if place in shipped_names():
        return "simulation"
    raise InputError(f"{printable(place)} is not there; give {FORMS}: {', '.join(shipped_names())}.")


def _trajectory(place: str, columns: dict[str, Floats], spec: Spec | None) -> Motion:
    named = names_of(spec) if spec is not None else Names.in_order(columns)
    return motion_of_columns(place, "trajectory", columns, named)
