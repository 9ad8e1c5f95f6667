"""A draft of a search says what the search would say, for less."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from rthm_analysis.diagnosis.fitting.fitting import Fitted, Fitting
from rthm_analysis.diagnosis.fitting.noise import white_noise
from rthm_analysis.diagnosis.physical import drafting
from rthm_analysis.diagnosis.physical.beginning import Baseline
from rthm_analysis.diagnosis.physical.drafting import draft_of, drafted
from rthm_analysis.diagnosis.physical.explaining import is_behind
from rthm_analysis.diagnosis.replay.experiment import Experiment
from rthm_analysis.diagnosis.replay.model import Model
from rthm_analysis.diagnosis.replay.windows import Windows, windows
from rthm_analysis.diagnosis.search import refining
from rthm_analysis.diagnosis.search.choosing import choose, never
from rthm_analysis.diagnosis.search.judging import Selection, reduced_chi2
from rthm_core.physical.side import first_command
from rthm_core.spec import Spec, apply

from .fittings import SIGMA, fitting_of
from .side import EVIDENCE, PAPER, having

TRUE = apply(
    having("plant", "coulomb_friction", force=0.5),
    {
        "effects": ["one", "cubic"],
        "cubic": {"block": "plant", "dof": "x1", "kind": "cubic_stiffness", "coefficient": 40.0},
    },
)
NOISE = np.array([1e-4, 2e-3, 0.02, 1e-5])
"""Reference noise of position, velocity, force and motor."""


def begun_with(fitting: Fitting) -> Baseline:
    nominal = fitting.fit(Model(PAPER))
    fitting.reduced_chi2 = reduced_chi2(fitting, nominal)
    return Baseline(fitting.windows, white_noise(SIGMA), fitting, nominal, nominal)


@pytest.fixture
def short_drafts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drafting, "DRAFT_FEWEST_SAMPLES", EVIDENCE.stamps_ns.size // 5)


@pytest.mark.parametrize(
    "spec",
    [
        PAPER,
        having("plant", "coulomb_friction", force=0.3),
        having("wire", "backlash", poles=True, gap=0.01),
        having("wire", "pulley_inertia", poles=True, mass=0.002, damping=0.05),
        having("sensor.velocity", "lag", time_constant=0.01),
    ],
    ids=lambda spec: spec.effects[0].kind if spec.effects else "plain",
)
def test_a_draft_is_the_same_motion_within_a_part_of_the_noise(spec: Spec) -> None:
    load = 0.2 * np.sin(3.0 * EVIDENCE.time)[:, None] * np.ones((1, EVIDENCE.load.shape[1]))
    whole = Experiment(replace(EVIDENCE, load=load), first_command(PAPER))
    runs = windows(EVIDENCE, PAPER, True)
    kept, few = runs.every(7, EVIDENCE.stamps_ns.size)
    draft = whole.draft(kept)
    wrong = draft.predicted(spec, few) - whole.predicted(spec, runs)[kept]
    assert np.all(np.sqrt(np.mean(wrong**2, axis=0)) < 0.1 * NOISE)
    assert np.abs(whole.predicted(spec, runs)).max() > 0.0


def test_windows_of_a_draft_begin_where_they_began() -> None:
    runs = Windows(np.array([0, 10, 25]), np.zeros((3, 2)), 1.0)
    kept, few = runs.every(4, 33)
    assert kept.tolist() == [0, 4, 8, 10, 14, 18, 22, 25, 29]
    assert kept[few.start].tolist() == runs.start.tolist()
    assert few.length == runs.length


@pytest.mark.usefixtures("short_drafts")
def test_a_draft_finds_what_a_search_finds_for_less() -> None:
    slow, fast = fitting_of(TRUE, 7), fitting_of(TRUE, 7)
    begun = begun_with(fast)
    found = choose(slow, begun_with(slow).retuned)
    some = draft_of(begun)
    assert some is not None
    draft = drafted(begun, some, never)
    assert draft is not None
    assert {t[0].label for t in draft.rounds} == {t[0].label for t in found.rounds}
    assert reduced_chi2(fast, draft.best) < 1.2
    assert draft.best.samples == EVIDENCE.stamps_ns.size * 3
    assert all(one.fitted.samples == draft.best.samples for t in draft.rounds for one in t)
    assert fast.budget.used < slow.budget.used


@pytest.mark.usefixtures("short_drafts")
def test_near_the_noise_nothing_is_drafted() -> None:
    begun = begun_with(fitting_of(PAPER, 8))
    assert draft_of(begun) is None


def test_a_second_search_that_had_to_end_early_takes_nothing_back() -> None:
    begun = begun_with(fitting_of(TRUE, 9))
    found, nothing = choose(begun.fitting, begun.retuned), Selection(begun.retuned, begun.retuned)
    assert not is_behind((begun, nothing), found)
    begun.fitting.budget.limit = 0.0
    assert is_behind((begun, nothing), found)
    assert not is_behind((begun, found), nothing)


def test_a_sensor_that_lags_takes_one_replay() -> None:
    runs = windows(EVIDENCE, PAPER, True)
    plain, lagging = (Experiment(EVIDENCE, first_command(PAPER)) for _ in range(2))
    plain.predicted(PAPER, runs)
    lagging.predicted(having("sensor.velocity", "lag", time_constant=0.01), runs)
    assert len(lagging._motions) == len(plain._motions) == 1


@pytest.mark.parametrize(
    ("draft", "before", "enough"), [(True, 100.0, 1.2), (True, 2.6, 1.08), (False, 100.0, 1.02)]
)
def test_a_plain_kind_suffices_in_a_draft_of_a_small_mismatch_only_where_it_leaves_little_of_it(
    monkeypatch: pytest.MonkeyPatch, draft: bool, before: float, enough: float
) -> None:
    monkeypatch.setattr(refining, "reduced_chi2", lambda fitting, fitted: fitted)
    fitting = SimpleNamespace(experiment=SimpleNamespace(is_draft=draft))
    found = refining._sufficient_chi2(cast("Fitting", fitting), cast("Fitted", before))
    assert found == pytest.approx(enough)
