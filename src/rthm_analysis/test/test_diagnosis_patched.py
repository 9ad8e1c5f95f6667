"""The patched spec is the model that was judged, whatever of its values is told."""

from __future__ import annotations

import numpy as np
import pytest

from rthm_analysis.diagnosis.physical import diagnose_physical, findings
from rthm_analysis.diagnosis.result import Part

from .plain import plant, recorded


def _part() -> Part:
    evidence = recorded(lambda t, x, v: -0.8 * v * abs(v), force=6.0, stiffness=13.0)
    spec = plant(stiffness=0.2)
    return findings.physical_part(diagnose_physical(evidence, spec, np.empty(0), lambda said: None))


def test_values_that_a_recording_does_not_determine_are_patched_beside_what_was_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(findings, "_determined", lambda values: {})
    part = _part()
    assert [one.kind for one in part.physics] == ["quadratic_drag"] and not part.retuned
    assert part.changes["plant.stiffness"] == pytest.approx(13.0, rel=0.01)
    (note,) = (one for one in part.notes if "does not determine" in one)
    assert "plant.stiffness 13" in note


def test_values_that_it_determines_are_told_and_patched_alike() -> None:
    part = _part()
    assert part.changes == {name: one.value for name, one in part.retuned.items()}
    assert not any("does not determine" in one for one in part.notes)
