"""The search for what is missing: where it begins, and what runs side by side."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.criteria.search import NEAR_NOISE_CHI2
from rthm_analysis.diagnosis.fitting.cores import Cores
from rthm_analysis.diagnosis.fitting.wires_alone import WiresAlone
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.replay.motor import motor_motion
from rthm_analysis.diagnosis.search import refining
from rthm_analysis.diagnosis.search.beside_wire import one_by_one, selected_from_wire
from rthm_analysis.diagnosis.search.choosing import choose
from rthm_analysis.diagnosis.search.judging import FittedCandidate, looked_for, reduced_chi2
from rthm_analysis.diagnosis.search.refining import fit_further, refined, unfitted
from rthm_analysis.diagnosis.search.screening import ScoredCandidate
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_analysis.diagnosis.search.wire_from_force import released, wires_from_force
from rthm_core.compiled import Floats
from rthm_core.errors import InputError
from rthm_core.spec import Spec, apply

from .fittings import fitting_of
from .side import COMMANDS, DUE, PAPER, having


@pytest.mark.parametrize(("known", "near"), [(0.5, 0.05), (2.65, 0.1)])
def test_a_wire_tells_what_it_does_beside_an_end_stop_that_nobody_knows_of(known: float, near: float) -> None:
    slack = having("wire", "slack", pretension=known)
    stop = {"block": "plant", "kind": "end_stop", "dof": "x1", "position": 0.3, "stiffness": 200.0}
    fitting = fitting_of(apply(slack, {"effects": ["one", "stop"], "stop": stop | {"damping": 1.0}}), 1)
    ((start, model),) = wires_from_force(fitting, fitting.fit(Model(PAPER)))
    (pretension,) = model.parameters
    assert start.added.kind == "slack" and pretension.prior is not None
    assert abs(pretension.value - known) < 4.0 * pretension.prior[1] < near
    assert released(model, 0).parameters[0].prior is None


def test_no_kind_of_a_wire_is_looked_for_where_an_offset_of_its_force_is_all() -> None:
    fitting = fitting_of(having("sensor.force", "bias", bias=0.45), 1)
    base = fitting.fit(Model(PAPER))
    used = fitting.budget.used
    assert wires_from_force(fitting, base) == []
    assert fitting.budget.used - used < 2.0 * base.samples
    fitting.reduced_chi2 = reduced_chi2(fitting, base)
    ((found, *_),) = choose(fitting, base).rounds
    assert found.label == ("sensor.force", "bias", "a1")


def test_beside_the_kind_that_explains_the_force_of_a_wire_no_other_is_looked_for_in_it() -> None:
    fitting = fitting_of(having("wire", "slack", pretension=0.5), 4)
    fitting.identified["a1"] = "slack"
    added = [EffectInstance("wire", "slack", "a1", {}), EffectInstance("wire", "bouc_wen", "a1", {})]
    added += [EffectInstance("wire", "bouc_wen", "a2", {}), EffectInstance("plant", "bouc_wen", "x1", {})]
    starts = [InitialGuess(one, (), ()) for one in added]
    assert list(looked_for(fitting, starts)) == [starts[0], *starts[2:]]


def test_what_the_force_of_a_wire_tells_leads_to_what_goes_with_it() -> None:
    slack = having("wire", "slack", pretension=0.5)
    stop = {"block": "plant", "kind": "end_stop", "dof": "x1", "position": 0.3, "stiffness": 200.0}
    fitting = fitting_of(apply(slack, {"effects": ["one", "stop"], "stop": stop | {"damping": 1.0}}), 1)
    base = fitting.fit(Model(PAPER))
    fitting.reduced_chi2 = reduced_chi2(fitting, base)
    led = selected_from_wire(fitting, base, choose)
    assert led is not None and fitting.identified == {"a1": "slack"}
    assert [tried[0].label[1] for tried in led.rounds][:2] == ["slack", "end_stop"]
    assert reduced_chi2(fitting, led.best) < 0.1 * reduced_chi2(fitting, base)


def test_plain_kinds_that_go_with_what_the_force_of_a_wire_tells_are_found_together() -> None:
    slack = having("wire", "slack", pretension=0.5)
    drag = {"block": "plant", "kind": "quadratic_drag", "dof": "x1", "coefficient": 1.0}
    spring = {"block": "plant", "kind": "cubic_stiffness", "dof": "x1", "coefficient": 60.0}
    both = {"effects": ["one", "drag", "spring"], "drag": drag, "spring": spring}
    fitting = fitting_of(apply(slack, both), 6)
    base = fitting.fit(Model(PAPER))
    fitting.reduced_chi2 = reduced_chi2(fitting, base)
    led = choose(fitting, base)
    assert {tried[0].label[1] for tried in led.rounds} == {"slack", "quadratic_drag", "cubic_stiffness"}
    assert reduced_chi2(fitting, led.best) < NEAR_NOISE_CHI2


def test_they_are_found_one_after_the_other_as_well() -> None:
    slack = having("wire", "slack", pretension=0.5)
    spring = {"block": "plant", "kind": "cubic_stiffness", "dof": "x1", "coefficient": 60.0}
    fitting = fitting_of(apply(slack, {"effects": ["one", "spring"], "spring": spring}), 6)
    base = fitting.fit(Model(PAPER))
    fitting.reduced_chi2 = reduced_chi2(fitting, base)
    ((start, model),) = wires_from_force(fitting, base)
    alone = fit_further(fitting, unfitted(start, base, model), None, 1)
    with fitting.simple_only():
        found = one_by_one(fitting, alone)
    assert [one.label[1] for one in found] == ["slack", "cubic_stiffness"]


@pytest.mark.parametrize("true", [PAPER, having("plant", "coulomb_friction", force=0.3)])
def test_a_wire_that_does_nothing_tells_nothing(true: Spec) -> None:
    fitting = fitting_of(true, 2)
    assert wires_from_force(fitting, fitting.fit(Model(PAPER))) == []


def test_a_wire_whose_force_was_not_measured_tells_nothing() -> None:
    fitting = fitting_of(having("wire", "slack", pretension=0.5), 3, "position", "velocity")
    assert wires_from_force(fitting, fitting.fit(Model(PAPER))) == []


def test_a_wire_that_the_spec_does_not_allow_only_does_not_come_into_question(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    fitting = fitting_of(having("wire", "slack", pretension=0.5), 4)
    replay = WiresAlone.residual

    def refusing(alone: WiresAlone, model: Model) -> Floats:
        if any(effect.kind == "bouc_wen" for effect in model.spec.effects):
            raise InputError("there is none here")
        return replay(alone, model)

    monkeypatch.setattr(WiresAlone, "residual", refusing)
    ((start, _),) = wires_from_force(fitting, fitting.fit(Model(PAPER)))
    assert start.added.kind == "slack"


def test_an_effect_that_never_acts_explains_nothing() -> None:
    fitting = fitting_of(PAPER, 5)
    fitted = fitting.fit(Model(PAPER))
    slack = EffectInstance("wire", "slack", "a1", {"pretension": 100.0})
    never = InitialGuess(slack, ("pretension",), (), {"pretension": 1.0})
    acts = replace(never, added=replace(slack, parameters={"pretension": 1.0}))
    promised = [ScoredCandidate(one, 100.0, np.inf) for one in (never, acts)]
    known = fitting.known(fitted)
    assert refined(fitting, fitted, known, promised[:1]) == []
    assert [one.start for one in refined(fitting, fitted, known, promised)] == [acts]


def test_a_memory_whose_fit_has_just_begun_is_no_worse_than_one_that_misses_the_noise() -> None:
    true = {"gain": 3.0, "frequency": 4.0, "damping_ratio": 0.3}
    fitting = fitting_of(having("plant", "fluid_memory", **true), 11)
    fitted = fitting.fit(Model(PAPER))

    def begun(kind: str, **values: float) -> FittedCandidate:
        start = InitialGuess(EffectInstance("plant", kind, "x1", values), tuple(values), (), dict(values))
        return unfitted(start, fitted, start.added_to(fitted.model))

    known = fitting.known(fitted)
    hidden = begun("hidden_mode", mass=0.1, frequency=4.0, damping_ratio=0.3)
    hidden = fit_further(fitting, hidden, known, 20)
    memory = fit_further(fitting, begun("fluid_memory", gain=0.5, frequency=3.0, damping_ratio=0.5), known, 1)
    assert memory.fitted.squares > hidden.fitted.squares
    assert reduced_chi2(fitting, hidden.fitted) > NEAR_NOISE_CHI2
    *_, longer = refining._beside_an_imitator(fitting, known, [memory, hidden])
    assert longer.label == memory.label and reduced_chi2(fitting, longer.fitted) < NEAR_NOISE_CHI2
    assert refining._beside_an_imitator(fitting, known, [hidden, longer]) == [hidden, longer]


def test_a_motor_of_limited_rate_keeps_its_mean_where_it_arrives_between_two_points_of_the_grid() -> None:
    spec, rate = having("motor", "rate_limit", rate=0.5), 0.5
    time = np.array([0, 5_000_000, 10_000_000])
    for reach in (0.0006, 0.002, -0.0011, 0.01):
        motion = motor_motion(spec, time, np.array([0]), np.array([[reach]]), np.zeros(1))[0, :, 0]
        instants = np.linspace(0.0, 5e-3, 100_001)
        exact = np.mean(np.sign(reach) * np.minimum(rate * instants, abs(reach)))
        assert abs(motion @ [1.0, 4.0, 1.0] / 6.0 - exact) < 1e-8


def test_a_motor_that_follows_at_once_stays_at_its_commands() -> None:
    motion = motor_motion(PAPER, DUE, DUE, COMMANDS, np.zeros(1))
    assert np.array_equal(motion[:-1], np.repeat(COMMANDS[:-1, None], 3, axis=1))


def test_work_in_parts_may_have_its_parts_done_side_by_side() -> None:
    cores = Cores()
    with np.errstate(over="raise"):
        found = cores.each_in_parts(lambda i: sum(cores.each(lambda j: i * j, range(20))), range(40))
        assert found == [190 * i for i in range(40)]
        with pytest.raises(FloatingPointError):
            cores.each(lambda x: np.float64(x) * 1e10, [1e300])
