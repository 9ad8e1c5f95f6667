"""What the plant lacks shows under the force that was measured, whatever the wires are."""

from __future__ import annotations

import numpy as np

from rthm_analysis.diagnosis.criteria.fitting import POOR_FIT_CHI2
from rthm_analysis.diagnosis.replay.model import EffectInstance, Model
from rthm_analysis.diagnosis.search.choosing import choose
from rthm_analysis.diagnosis.search.driven_plant import driven_plant, short_runs
from rthm_analysis.diagnosis.search.judging import reduced_chi2
from rthm_core.spec import apply

from .fittings import fitting_of
from .side import PAPER, having

STOP = {"position": 0.3, "stiffness": 200.0, "damping": 1.0}
BOTH = apply(
    having("wire", "slack", pretension=0.5),
    {"effects": ["one", "stop"], "stop": {"block": "plant", "kind": "end_stop", "dof": "x1"} | STOP},
)


def test_an_end_stop_is_found_in_the_plant_alone_beside_a_slack_wire() -> None:
    fitting = fitting_of(BOTH, 1)
    driven = driven_plant(fitting, fitting.fit(Model(PAPER)))
    assert driven is not None and not driven.experiment.evidence.commands.size
    assert driven.base.spec.actuator is None
    base = driven.fit(driven.base)
    driven.reduced_chi2 = reduced_chi2(driven, base)
    left = driven.reduced_chi2
    found = choose(driven, base)
    assert found.rounds[0][0].label == ("plant", "end_stop", "x1")
    assert abs(float(found.best.model.effect_values(0)["position"]) - STOP["position"]) < 0.01
    assert reduced_chi2(driven, found.best) < 0.01 * left


def test_the_plant_that_is_as_specified_lacks_nothing() -> None:
    fitting = fitting_of(having("wire", "slack", pretension=0.5), 2)
    driven = driven_plant(fitting, fitting.fit(Model(PAPER)))
    assert driven is not None
    base = driven.fit(driven.base)
    assert reduced_chi2(driven, base) < POOR_FIT_CHI2


def test_nothing_is_driven_by_a_force_that_was_not_measured() -> None:
    fitting = fitting_of(BOTH, 3, "position", "velocity")
    assert driven_plant(fitting, fitting.fit(Model(PAPER))) is None


def test_in_short_runs_the_true_model_leaves_noise() -> None:
    fitting = fitting_of(BOTH, 4)
    slack = EffectInstance("wire", "slack", "a1", {"pretension": 0.5})
    stop = EffectInstance("plant", "end_stop", "x1", dict(STOP))
    short = short_runs(fitting, Model(PAPER).plus(slack, (), {}).plus(stop, (), {}))
    assert short.windows.start.size > 1
    assert np.isclose(reduced_chi2(short, short.fit(short.base)), 1.0, atol=0.2)
