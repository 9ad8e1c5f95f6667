"""A position whose zero wanders is its sensor's where the other dof denies every force that would do it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.diagnosis.diagnose import diagnose
from rthm_analysis.diagnosis.physical import diagnose_physical
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.physical.shown_elsewhere import forces_on, is_denied, moved_elsewhere
from rthm_analysis.diagnosis.physical.wandering import wandering
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.search.replacing import is_seen
from rthm_analysis.exchange.bag import write_bag
from rthm_analysis.recording import Recording, Table, read_recording
from rthm_analysis.recording.cdr import FIELDS
from rthm_core.spec import Spec
from rthm_core.substructure import substructure
from rthm_core.topics import PLANT_STATE

from .test_diagnosis_between import NOISE, STIFFNESS, Law, recorded, two_dofs

HERE = 1
"""Column of the position of the second dof."""


def positions(law: Law = lambda x, v: (0.0, 0.0), seed: int = 0, off: np.ndarray | None = None) -> Evidence:
    """Both positions and the velocity of the first dof; that of the second reads so much more."""
    seen = recorded(law, seed=seed).without([3])
    if off is None:
        return seen
    measured = seen.measured.copy()
    measured[:, HERE] += off
    return replace(seen, measured=measured)


def asked(seen: Evidence, spec: Spec | None = None):  # type: ignore[no-untyped-def]
    return wandering(seen, spec or two_dofs(), lambda said: None)


TIME = np.arange(4001) * 0.005


@pytest.mark.parametrize(
    "error",
    [
        20.0 * NOISE[0] * np.sin(2.0 * np.pi * TIME / 9.0 + 0.5),
        4.0 * NOISE[0] * np.sin(2.0 * np.pi * TIME / 14.0),
        50.0 * NOISE[0] * TIME / TIME[-1],
        np.full(TIME.size, 30.0 * NOISE[0]),
    ],
    ids=["slow", "small", "straight", "steady"],
)
def test_a_zero_that_wanders_is_told_and_taken_out(error: np.ndarray) -> None:
    seen = positions(off=error)
    one = asked(seen)
    assert one is not None and one.is_all and not one.instead
    assert np.sqrt(np.mean(np.square(one.error - error))) < NOISE[0]
    fault = one.fault(seen)
    assert (fault.block, fault.kind, fault.channel) == ("sensor.position", "wander", "x2.position")
    part = physical_part(diagnose_physical(one.corrected(seen), two_dofs(), np.empty(0), lambda said: None))
    assert not (part.physics or part.described or part.unexplained)


def test_a_signal_of_which_more_is_wrong_is_left_out() -> None:
    walk = np.cumsum(np.random.default_rng(4).normal(size=TIME.size)) * NOISE[0]
    one = asked(positions(off=walk))
    assert one is not None and not one.is_all
    assert [c.signal for c in one.corrected(positions()).channels] == ["x1", "v1"]


def test_values_that_are_uncertain_are_fitted_to_the_other_signals() -> None:
    error = 20.0 * NOISE[0] * np.sin(2.0 * np.pi * TIME / 9.0)
    one = asked(positions(off=error), two_dofs(1.01 * STIFFNESS, stiffness=0.05))
    assert one is not None and np.sqrt(np.mean(np.square(one.error - error))) < 3.0 * NOISE[0]


@pytest.mark.parametrize(
    "law",
    [
        lambda x, v: (0.0, 0.0),
        lambda x, v: (0.0, 0.05),
        lambda x, v: (0.0, -40.0 * x[1] ** 3),
        lambda x, v: (0.02, -0.02),
    ],
    ids=["nothing", "load", "spring", "load between"],
)
def test_a_force_is_no_error_of_a_sensor(law: Law) -> None:
    assert asked(positions(law)) is None


def test_a_link_that_changes_its_length_is_told_beside_the_sensor() -> None:
    plant = substructure(two_dofs(np.array([[40.0, -10.0], [-10.0, 10.0]])).plant)
    (_, alone), (between,) = forces_on(2)
    error, noise = 20.0 * NOISE[0] * np.sin(0.7 * TIME), np.random.default_rng(0).normal(size=TIME.size)
    shown = [moved_elsewhere(plant, one, error, 0.005, (1, 0), 0) for one in (alone, between)]
    assert [is_denied(one, NOISE[0] * noise, NOISE[0]) for one in shown] == [True, False]


@pytest.mark.parametrize(("misfit", "is_told"), [(1.0, True), (1e6, False)])
def test_an_effect_that_may_be_zero_beside_what_is_left_is_not_seen(misfit: float, is_told: bool) -> None:
    best = diagnose_physical(positions(lambda x, v: (0.0, 0.05)), two_dofs(), np.empty(0), lambda said: None)
    assert is_seen(best.selection.best, 0, misfit) is is_told


def bag(path: Path, seen: Evidence) -> Recording:
    """Both positions, the velocity of the first dof and the known forces."""
    first, second, speed = seen.measured.T
    none = np.full((seen.stamps_ns.size, 2), np.nan)
    known = {
        "position": np.column_stack([first, second]),
        "velocity": np.column_stack([speed, none[:, 1]]),
        "effort": seen.load,
    }
    columns = {field: known.get(field, none) for field in FIELDS}
    stamps = seen.stamps_ns
    write_bag(path, {PLANT_STATE: Table(stamps, stamps, stamps, ("x1", "x2"), **columns)}, {}, "")
    return read_recording(path)


def test_a_recording_with_a_zero_that_wanders_is_explained_by_it_alone(tmp_path: Path) -> None:
    error = 20.0 * NOISE[0] * np.sin(2.0 * np.pi * TIME / 9.0 + 0.5)
    found = diagnose(bag(tmp_path / "bag", positions(off=error)), two_dofs())
    assert found.verdict == "explained" and [one.kind for one in found.faults] == ["wander"]
    assert not (found.physics or found.described or found.retuned)
