"""A recording together with the model that it is compared with."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from rthm_analysis.recording.reading import read_recording
from rthm_analysis.recording.recording import Recording
from rthm_core.effects import load_effects
from rthm_core.spec import Spec, spec_at


def read_with_spec(
    bag: str | Path | Recording, spec: Spec | Path | str | None = None, effects: Iterable[str | Path] = ()
) -> tuple[Recording, Spec]:
    """Read a recording, and its nominal model.

    Parameters
    ----------
    bag
        A folder or a file, or a recording that was read before.
    spec
        What names the model; the recording's own spec when absent.
    effects
        Python files, or modules, that declare further kinds of effects. They are executed.

    Raises
    ------
    InputError
        If the recording or the spec cannot be read.
    """
    loaded = load_effects(effects)
    recording = bag if isinstance(bag, Recording) else read_recording(bag)
    return recording, spec_at(recording.known_spec() if spec is None else spec, loaded)
