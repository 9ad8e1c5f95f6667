"""Everything about one recorded test: what the analysis node and the page are made from."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rthm_analysis.energy import EnergyResult, energy_of
from rthm_analysis.recording import read_recording
from rthm_analysis.timing import TimingResult, timing_of
from rthm_core.files import write_whole


def analyse_bag(bag: str | Path) -> tuple[EnergyResult, TimingResult]:
    """Energy and timing of a recording; InputError when they cannot be computed."""
    recording = read_recording(bag)
    return energy_of(recording, recording.spec), timing_of(recording, recording.spec)


def write_beside(bag: str | Path, energy: EnergyResult) -> Path:
    """Write the energies as JSON beside the bag, ``NAME.energy.json``, and return where.

    The file appears at once and whole, so that nobody reads half of it.

    Raises
    ------
    InputError
        It cannot be written.
    """
    place = Path(bag).resolve()
    target = place.with_name(f"{place.name}.energy.json")
    write_whole(target, to_json(energy.as_dict()))
    return target


def to_json(result: Mapping[str, Any]) -> str:
    """Result as JSON; what is not finite becomes null."""
    return json.dumps(_finite(result), allow_nan=False)


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _finite(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
