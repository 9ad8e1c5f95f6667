"""The model that a recording is compared with."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from rthm_analysis.recording.recording import Recording
from rthm_core.spec import Spec, spec_at, write_spec


def with_spec(recording: Recording, spec: Spec | Path | str | None) -> Recording:
    """Return the recording as one that has this spec, whatever its own is; None: as it is.

    Raises
    ------
    InputError
        If it is not a spec.
    """
    if spec is None:
        return recording
    given = spec_at(spec)
    notes = tuple(note for note in recording.notes if note not in recording.spec_notes)
    return replace(recording, spec=given, spec_text=write_spec(given), notes=notes)


def nominal_spec(
    recording: Recording, spec: Spec | Path | str | None = None, effects: Iterable[str | Path] = ()
) -> Spec:
    """Return the nominal model of a recorded test.

    Parameters
    ----------
    recording
        The test.
    spec
        What names the model; the recording's own spec when absent.
    effects
        Python files, or modules, that declare further kinds of effects. They are executed.

    Raises
    ------
    InputError
        If there is no spec that can be read.
    """
    return spec_at(recording.known_spec() if spec is None else spec, effects)
