"""``rthm energy``: energy balance of a recording."""

from __future__ import annotations

from typing import Any

from rthm_bringup.cli.options import Bag, Effects, Json, SpecOfBag, recording_of

EXAMPLES = ("rthm energy out/bag",)


def verb(bag: Bag, spec: SpecOfBag = None, effects: Effects = None, json: Json = None) -> int:
    """Account for the energy of a recorded test, term by term."""
    from rthm_analysis.energy import energy_of
    from rthm_bringup.cli.output import put, table
    from rthm_bringup.run.result import last_values

    recording = recording_of(bag, effects, spec)
    result: dict[str, Any] = energy_of(recording, recording.known_spec()).as_dict()
    result["notes"] = [*recording.notes, *result["notes"]]
    rows = [(name, f"{value:+.3e} J") for name, value in last_values(result).items()]
    put(result, [*table(rows), *recording.notes], json)
    return 0
