"""The next test: predicted as the exact engine would, within the limits, and worth its time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest

from rthm_analysis.diagnosis.experiment.closed import fastest_motion
from rthm_analysis.diagnosis.experiment.planning import Hypothesis, Planned, plan_experiment
from rthm_analysis.diagnosis.experiment.predicting import Predicted, Predictor, step_of
from rthm_analysis.diagnosis.experiment.trials import Trial, constant, harmonic, multisine
from rthm_analysis.diagnosis.replay.kernel import replay_mechanics
from rthm_core.engine import simulate
from rthm_core.spec import Spec, apply, read_spec, shipped_spec

PAPER, DECAY = shipped_spec("paper"), shipped_spec("decay")
NOISE = {"x1": 1e-4, "v1": 2e-3, "F": 0.02}
BRANCH = {"block": "plant", "kind": "maxwell_branch", "dof": "x1", "stiffness": 0.5, "damping": 0.3}
DRY = {"block": "plant", "kind": "coulomb_friction", "dof": "x1", "force": 0.05}
CUBIC = {"block": "plant", "kind": "cubic_stiffness", "dof": "x1", "coefficient": 1.0}
WIRE = {"block": "wire", "kind": "maxwell_branch", "actuator": "a1", "stiffness": 5.0, "damping": 1.0}

HARD = {"block": "wire", "kind": "hardening", "actuator": "a1", "coefficient": 100.0}


def having(nominal: Spec, **effects: dict) -> Spec:
    return apply(nominal, {"effects": list(effects), **effects})


def planned(nominal: Spec, *specs: Spec, duration: float = 20.0, **more: object) -> Planned | None:
    hypotheses = [Hypothesis(f"hypothesis {i}", spec) for i, spec in enumerate(specs)]
    return plan_experiment(nominal, hypotheses, NOISE, duration, **more)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "spec",
    [
        PAPER,
        having(PAPER, one=BRANCH),
        having(PAPER, one=WIRE),
        apply(PAPER, {"actuator.motor_poles": [400.0, 2000.0], "timing.td4": 0.004}),
        apply(PAPER, {"actuator.compensator": "polynomial", "interface.damping": 2.0}),
        apply(PAPER, {"timing.td1": 1e-4, "timing.td2": 1e-3, "timing.td3": 4e-4}).scaled_timing(0.3),
        DECAY,
    ],
)
@pytest.mark.parametrize("side", ["release", "plant", "numerical"])
def test_a_test_is_predicted_as_the_exact_engine_simulates_it(spec: Spec, side: str) -> None:
    if side == "numerical" and not spec.is_loop:
        return
    loads = {"plant": multisine("x1", 0.3, 1.0, 5.0, 5), "numerical": harmonic("x2", 0.5, 3.0)}
    trial = Trial({side: loads[side]}) if side in loads else Trial({}, 0.7)
    step = round(min(step_of(spec), 0.02), 4)
    found = Predictor(spec, step, 500).predict(trial)
    exact = simulate(trial.changed(spec), 500 * step, step, energies=False)
    off = found.signals["x1"] - exact.plant_position[:, 0]
    assert np.sqrt(np.mean(off**2)) < 0.01 * exact.plant_position.std()


def test_the_predicted_difference_is_that_of_the_exact_engine() -> None:
    specs = PAPER, having(PAPER, one=BRANCH)
    plan = planned(PAPER, *specs)
    assert plan is not None and plan.gain > 1.3 * plan.present and plan.signal in NOISE
    for trial, told in ((plan.trial, plan.gain), (Trial({}, 1.0), plan.present)):
        one, other = (simulate(trial.changed(spec), 20.0, 0.01, energies=False) for spec in specs)
        apart = np.sqrt(np.mean((one.plant_position - other.plant_position) ** 2)) / NOISE["x1"]
        assert told == pytest.approx(apart, rel=0.05)


def test_the_planned_spec_is_the_nominal_one_with_another_input(tmp_path: Path) -> None:
    plan = planned(PAPER, having(PAPER, one=DRY), having(PAPER, one=CUBIC))
    assert plan is not None
    (tmp_path / "next.yaml").write_text(plan.spec)
    spec = read_spec(str(tmp_path / "next.yaml"))
    back = {"load": None, "plant.initial_position": 0.5, "numerical.initial_position": 0.0}
    assert apply(spec, back) == apply(PAPER, back)
    assert spec == plan.trial.changed(PAPER) and spec != PAPER


@pytest.mark.parametrize("limits", [{"command": 0.3}, {"force": 1.5}, {"rate": 0.8}])
def test_every_hypothesis_stays_within_the_limits(limits: dict[str, float]) -> None:
    nominal = apply(PAPER, {"limits": limits, "plant.initial_position": 0.2})
    specs = [having(nominal, one=CUBIC | {"coefficient": size}) for size in (0.0, 20.0)]
    plan = planned(nominal, *specs)
    assert plan is not None
    for spec in specs:
        found = Predictor(spec, 0.01, 2000).predict(plan.trial)
        assert all(found.largest(family) < most for family, most in limits.items())


def test_without_limits_a_planned_test_stays_near_the_range_of_the_present_one() -> None:
    plan = planned(DECAY, DECAY, having(DECAY, one=CUBIC))
    assert plan is not None
    assert Predictor(DECAY, 0.01, 2000).predict(plan.trial).largest("position") <= 2.0 * 0.5 + 1e-9


def test_a_load_that_only_the_recording_knows_is_the_present_test() -> None:
    still = apply(DECAY, {"plant.initial_position": 0.0})
    time = np.linspace(0.0, 20.0, 2001)
    known = time, 0.2 * np.sin(2.0 * time)[:, None]
    assert planned(still, still, having(still, one=CUBIC)) is None  # nothing moves
    plan = planned(still, still, having(still, one=CUBIC), known=known)
    assert plan is not None and plan.present > 0.0
    (load,) = plan.trial.loads.values()
    assert getattr(load, "amplitude", 0.0) <= 0.4


def test_what_grows_by_itself_is_not_proposed() -> None:
    unstable = PAPER.scaled_timing(25.0)
    assert planned(unstable, unstable, having(unstable, one=DRY)) is None


def test_one_hypothesis_needs_no_test() -> None:
    assert planned(PAPER, PAPER) is None
    assert planned(PAPER, PAPER, PAPER) is None


def test_the_work_is_counted_and_the_plan_repeats(monkeypatch: pytest.MonkeyPatch) -> None:
    count, predict = [0], Predictor.predict

    def counted(one: Predictor, trial: Trial) -> object:
        count[0] += 1
        return predict(one, trial)

    monkeypatch.setattr(Predictor, "predict", counted)
    plans = [planned(PAPER, PAPER, having(PAPER, one=CUBIC), budget=30) for _ in range(2)]
    assert plans[0] == plans[1] and count[0] <= 60


def test_numbers_that_are_said_are_those_that_were_predicted() -> None:
    assert harmonic("x1", 0.7654, 1.98765).amplitude == 0.77
    assert Trial({"plant": constant("x1", 1.0)}, 0.5).scaled(1.0 / 3.0).loads["plant"].force == 0.33  # type: ignore[union-attr]
    assert fastest_motion(DECAY) == pytest.approx(np.sqrt(10.0), rel=1e-3)


def _field(record: Any, name: str) -> Any:
    """Type of a field of a record."""
    return record.types[record.fields.index(name)]


def test_plans_with_a_hypothesis_in_common_predict_it_once(monkeypatch: pytest.MonkeyPatch) -> None:
    def by_turns(seen: dict[str, Predicted] | None) -> list[Planned | None]:
        return [planned(PAPER, PAPER, having(PAPER, one=more), budget=12, seen=seen) for more in (CUBIC, DRY)]

    asked: list[bool] = []
    predict = Predictor.predict

    def counted(one: Predictor, trial: Trial) -> Predicted:
        asked.append(bool(one.spec.effects))
        return predict(one, trial)

    monkeypatch.setattr(Predictor, "predict", counted)
    apart = by_turns(None)
    before = asked.copy()
    asked.clear()
    assert by_turns({}) == apart
    assert asked.count(True) == before.count(True)
    assert 2 * asked.count(False) <= before.count(False) + 2


@pytest.mark.parametrize("nominal", [PAPER, DECAY])
def test_a_plan_compiles_nothing_of_its_own(nominal: Spec) -> None:
    planned(nominal, nominal, having(nominal, one=CUBIC), budget=10)
    if nominal.is_loop:
        planned(nominal, nominal, having(nominal, one=HARD))
    compiled = [one[0] for one in replay_mechanics.signatures]  # type: ignore[attr-defined]
    assert sum(_field(_field(one, "laws"), "heavy") == numba.none for one in compiled) == 1
