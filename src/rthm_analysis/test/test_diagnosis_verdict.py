"""A verdict is a test: what unseen data do not confirm is not said, and a plainer hypothesis comes first."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from rthm_analysis.diagnosis.fitting.fitting import Fitted
from rthm_analysis.diagnosis.physical import confirming, diagnose_physical, verdict
from rthm_analysis.diagnosis.physical.confirming import rivalled
from rthm_analysis.diagnosis.physical.findings import physical_part
from rthm_analysis.diagnosis.physical.judged import Simulated
from rthm_analysis.diagnosis.physical.rounding import is_rounding
from rthm_analysis.diagnosis.physical.side import Physical
from rthm_analysis.diagnosis.physical.verdict import Judgement
from rthm_analysis.diagnosis.replay.evidence import Evidence
from rthm_analysis.diagnosis.result import Part
from rthm_core.spec import Spec, apply

from .plain import DAMPING, STIFFNESS, plant, recorded, wandering


def part_of(evidence: Evidence, spec: Spec | None = None) -> Part:
    return physical_part(diagnose_physical(evidence, spec or plant(), np.empty(0), lambda said: None))


def test_noise_that_wanders_is_no_physics() -> None:
    part = part_of(recorded(noise=wandering(0.3, 3.0)))
    assert not part.physics and not part.unexplained and not part.retuned


def test_a_load_that_is_off_is_no_colour_of_the_noise() -> None:
    seen = recorded(duration=6.0)
    part = part_of(
        replace(seen, load=1.07 * seen.load, channels=seen.channels[:1], measured=seen.measured[:, :1])
    )
    assert part.retuned and not part.physics and not part.unexplained


def test_other_damping_and_stiffness_than_the_exact_ones_of_the_spec_are_no_missing_physics() -> None:
    part = part_of(recorded(damping=3.0 * DAMPING, stiffness=1.027 * STIFFNESS))
    assert not part.physics and not part.unexplained
    assert set(part.retuned) == {"plant.damping", "plant.stiffness"}
    for name, true in (("plant.damping", 3.0 * DAMPING), ("plant.stiffness", 1.027 * STIFFNESS)):
        assert abs(part.retuned[name].value - true) < 4.0 * part.retuned[name].std


def test_a_stiffness_that_is_off_over_forty_periods_is_retuned() -> None:
    part = part_of(recorded(force=0.0, start=0.4, duration=80.0, stiffness=0.985 * STIFFNESS), plant(0.4))
    assert not part.physics and not part.unexplained
    value = part.retuned["plant.stiffness"]
    assert abs(value.value - 0.985 * STIFFNESS) < 4.0 * value.std


def test_a_motion_that_dies_away_by_itself_does_not_tell_the_mass() -> None:
    spec = plant(0.4, mass=0.05, damping=0.5, stiffness=0.05)
    part = part_of(recorded(force=0.0, start=0.4, duration=80.0, stiffness=1.03 * STIFFNESS), spec)
    assert not part.physics and not part.unexplained and "plant.mass" not in part.retuned
    stiffness = part.retuned["plant.stiffness"]
    assert stiffness.value == pytest.approx(1.03 * STIFFNESS, rel=1e-3)
    assert stiffness.std == pytest.approx(0.05 * STIFFNESS, rel=0.1)


@pytest.mark.parametrize(("off", "told"), [(1e-4, False), (1e-3, True)])
def test_values_within_what_clocks_are_good_for_are_the_same(off: float, told: bool) -> None:
    quiet = recorded(force=0.0, start=2.0, stiffness=(1.0 + off) * STIFFNESS, damping=0.2)
    part = part_of(quiet, apply(plant(2.0, stiffness=0.05), {"plant.damping": [0.2]}))
    assert not part.unexplained and bool(part.retuned) == told


def test_a_name_that_predicts_no_better_than_rest_is_not_earned(monkeypatch: pytest.MonkeyPatch) -> None:
    errors = {"retuned": 3.0, "explained": 1.0}
    monkeypatch.setattr(verdict, "nrmse", lambda physical, predicted, channel: errors[predicted])
    monkeypatch.setattr(verdict, "spread", lambda physical, channel: 1.0)
    physical = SimpleNamespace(noise=SimpleNamespace(level=[0.01]))
    runs = {name: Simulated(cast("Fitted", None), cast("np.ndarray", name)) for name in errors}
    assert Judgement(cast("Physical", physical), runs).is_worse
    errors["explained"] = 0.5
    assert not Judgement(cast("Physical", physical), runs).is_worse


def test_few_samples_of_each_period_are_no_mismatch() -> None:
    often = recorded(force=0.0, start=2.0, duration=60.0)
    few = slice(None, None, 20)
    seen = replace(often, stamps_ns=often.stamps_ns[few], load=often.load[few], measured=often.measured[few])
    part = part_of(seen, plant(2.0))
    assert not part.physics and not part.unexplained and not part.retuned


def test_a_stiffness_that_is_off_is_retuned_with_few_samples_of_each_period() -> None:
    often = recorded(force=0.0, start=0.4, duration=70.0, stiffness=0.9 * STIFFNESS)
    few = slice(None, None, 16)
    seen = replace(often, stamps_ns=often.stamps_ns[few], load=often.load[few], measured=often.measured[few])
    part = part_of(seen, plant(0.4, stiffness=0.05))
    assert not part.physics and not part.unexplained and not part.described
    assert part.retuned["plant.stiffness"].value == pytest.approx(0.9 * STIFFNESS, rel=1e-3)


def test_no_more_changes_of_a_model_are_told_than_are_looked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, said in (("is_worse", False), ("_are_seen", True), ("_is_enough_at_noise", True)):
        monkeypatch.setattr(Judgement, name, said)

    def earned(spec: Spec, *freed: str) -> bool:
        base = SimpleNamespace(model=SimpleNamespace(parameters=[SimpleNamespace(key=key) for key in freed]))
        selection = SimpleNamespace(
            rounds=[0, 0, 0], in_pieces=False, blames_several=False, formulas=0, base=base
        )
        judgement = Judgement(cast("Physical", SimpleNamespace(selection=selection, spec=spec)), {})
        vars(judgement).update(is_driven_wrong=False, at_noise=True)
        return judgement.earned

    assert earned(plant())
    assert not earned(plant(), "plant.damping[0]")
    assert earned(plant(damping=0.2), "plant.damping[0]")


@pytest.mark.parametrize("remembers", [False, True])
def test_what_imitates_is_named_with_values_that_are_not_told_where_only_its_memory_explains(
    monkeypatch: pytest.MonkeyPatch, remembers: bool
) -> None:
    for name, said in (("mismatch", 0.0), ("_is_vague", True), ("_remembers", remembers)):
        monkeypatch.setattr(Judgement, name, said)
    physical = SimpleNamespace(selection=SimpleNamespace(rounds=[0], imitates=True))
    assert Judgement(cast("Physical", physical), {})._is_enough_at_noise is remembers


def test_what_shows_in_the_unseen_part_alone_is_told_as_unconfirmed() -> None:
    part = part_of(recorded(lambda t, x, v: -40.0 * max(x - 0.05, 0.0) if t > 19.0 else 0.0))
    assert not part.physics and not part.effects
    assert any("unconfirmed" in said for said in part.unexplained)
    assert all(one.held_out_gain == 0.0 for one in part.described)


@pytest.mark.parametrize(
    ("law", "depends_on"),
    [
        (lambda t, x, v: 2e-3 / (0.35 - x) ** 2, ("x",)),
        (lambda t, x, v: -0.06 * np.tanh(v / 1e-3) if 0.03 < x < 0.09 else 0.0, ("x", "v")),
    ],
    ids=["magnet", "rubs in one place"],
)
def test_a_force_of_no_kind_is_described_and_not_named(law, depends_on: tuple[str, ...]) -> None:  # type: ignore[no-untyped-def]
    part = part_of(recorded(law))
    assert not part.physics
    assert part.described[0].depends_on == depends_on
    assert part.described[0].held_out_gain > 0.9
    assert part.described[0].formula
    assert [one["kind"] for one in part.effects] == ["formula"] * len(part.effects)


@pytest.mark.long
def test_a_sensor_that_knows_no_sign_makes_no_laws_of_the_plant() -> None:
    seen = recorded()
    part = part_of(replace(seen, channels=seen.channels[:1], measured=np.abs(seen.measured[:, :1])))
    assert not part.physics and part.unexplained


def test_a_velocity_that_is_wrong_now_and_then_is_no_noise_and_no_force() -> None:
    seen = recorded()
    measured = seen.measured.copy()
    for begin in range(100, measured.shape[0], 300):
        measured[begin : begin + 20, 1] = measured[begin, 1] + 0.2
    part = part_of(replace(seen, measured=measured))
    assert not part.physics and not part.described and part.unexplained
    assert [one.block for one in part.blocks if one.significant] == ["sensor.velocity"]


def test_a_kind_of_the_library_is_named_with_its_value() -> None:
    part = part_of(recorded(lambda t, x, v: -20.0 * x**3))
    assert [one.kind for one in part.physics] == ["cubic_stiffness"] and not part.unexplained
    value = part.physics[0].parameters["coefficient"]
    assert abs(value.value - 20.0) < 3.0 * value.std


def test_what_matters_little_is_told_unless_another_kind_would_do_nearly_as_well() -> None:
    def tried(*errors: float) -> list[SimpleNamespace]:
        return [SimpleNamespace(error=error) for error in errors]

    base = SimpleNamespace(left_out=np.array([1000.0]))
    selection = SimpleNamespace(
        base=base, rounds=[tried(500.0, 510.0), tried(400.0, 480.0), tried(300.0, 305.0)]
    )
    physical = cast(Physical, SimpleNamespace(selection=selection))
    assert rivalled(physical, [0.001, 0.001, 0.001], 0.01) == [0, 2]
    assert rivalled(physical, [0.5, 0.001, -0.1], 0.01) == []  # what matters, or makes up for others, stays


@pytest.mark.parametrize(("off", "rounds"), [(0.0, True), (0.4, False)])
def test_a_coarse_sensor_may_read_what_is_predicted_rounded(off: float, rounds: bool) -> None:
    predicted = 0.7 * np.sin(0.01 * np.arange(3000.0))[:, None]
    coarse = 0.5 * np.round((predicted + off) / 0.5)
    physical = cast(Physical, SimpleNamespace(evidence=SimpleNamespace(measured=coarse), train=2000))
    assert is_rounding(physical, predicted, 0) is rounds
    assert is_rounding(physical, predicted + 1e-3, 0) is rounds


def test_what_matters_little_and_is_not_known_well_is_not_told(monkeypatch: pytest.MonkeyPatch) -> None:
    went: list[int] = []
    monkeypatch.setattr(confirming, "is_sure", lambda best, index, share: index == 1)
    monkeypatch.setattr(confirming, "without_each", lambda physical, indices: went.extend(indices))
    label = ("plant", "cubic_stiffness", "x1")
    selection = SimpleNamespace(best=None, rounds=[[SimpleNamespace(label=label)]] * 3)
    _, refused = confirming.without_slight(
        cast(Physical, SimpleNamespace(selection=selection)), [0.9, 0.01, 0.01]
    )
    assert went == [2] and [one.kind for one in refused] == ["cubic_stiffness"]


@pytest.mark.parametrize(("quiet", "at_noise"), [([False, False], False), ([True, False], True)])
def test_sensors_do_not_deny_what_is_left_of_all_of_them(
    monkeypatch: pytest.MonkeyPatch, quiet: list[bool], at_noise: bool
) -> None:
    monkeypatch.setattr(Judgement, "_is_noise_of_sensor", lambda self, channel: True)
    judged = Judgement(cast(Physical, None), {})
    judged.__dict__["_quiet_channels"] = quiet
    assert judged.at_noise is at_noise


def test_a_stiffness_that_drifts_is_described_over_position_and_time() -> None:
    part = part_of(recorded(lambda t, x, v: -1.0 * x * t / 24.0))
    assert not part.physics and part.described[0].depends_on == ("x", "t")
    assert part.described[0].held_out_gain > 0.95


def test_a_position_that_drifts_is_described_over_time_alone() -> None:
    seen = recorded()
    drifting = seen.measured + np.arange(seen.measured.shape[0])[:, None] * np.array([3e-3 / 4800, 0.0])
    part = part_of(replace(seen, measured=drifting))
    assert not part.physics and [one.depends_on for one in part.described] == [("t",)]


def test_a_drift_of_one_sensor_is_named_as_that() -> None:
    seen = recorded()
    drifting = seen.measured + np.arange(seen.measured.shape[0])[:, None] * np.array([0.0, 1e-2 / 4800])
    assert [(one.block, one.kind) for one in part_of(replace(seen, measured=drifting)).physics] == [
        ("sensor.velocity", "drift")
    ]


def test_a_slow_force_that_two_sensors_show_is_no_noise() -> None:
    def wind(t: float, x: float, v: float) -> float:
        return 0.004 * float(np.sin(np.array([0.23, 0.37, 0.61, 0.83]) * t + np.arange(4.0)).sum())

    assert part_of(recorded(wind)).unexplained
