"""What to do next fits what was found, and is a spec where it is a test of the rig."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from rthm_analysis.diagnosis.experiment.advice import FAULT, fault_advice
from rthm_analysis.diagnosis.experiment.next_test import Found, Next, next_experiment
from rthm_analysis.diagnosis.experiment.planning import Hypothesis
from rthm_analysis.diagnosis.result import Fault, Limit, Physics, Retuned, Value
from rthm_core.effects import BLOCKS, effect, kinds
from rthm_core.spec import Spec, apply, read_spec, shipped_spec

PAPER, DECAY = shipped_spec("paper"), shipped_spec("decay")
DRY = {"block": "plant", "kind": "coulomb_friction", "dof": "x1", "force": 0.05}
CUBIC = {"block": "plant", "kind": "cubic_stiffness", "dof": "x1", "coefficient": 1.0}


def having(nominal: Spec, **effects: dict) -> Spec:
    return apply(nominal, {"effects": list(effects), **effects})


def physics(block: str, kind: str, place: str | None = "x1", share: float = 0.9, **more: Any) -> Physics:
    return Physics(block, kind, place, more, "words", 0.0, share)


def after(
    nominal: Spec = PAPER, verdict: str = "explained", patched: Spec | None = None, **more: Any
) -> Next:
    given: dict[str, Any] = {"physics": (), "faults": (), "retuned": {}, "limits": {}, "rivals": ()} | more
    noise = {"x1": 1e-4, "v1": 2e-3, "F": 0.02}
    return next_experiment(
        Found(nominal, patched or nominal, verdict, noise=noise, duration=20.0, **given)  # type: ignore[arg-type]
    )


def spec_of(said: Next, folder: Path) -> Spec:
    assert said.spec is not None
    (folder / "next.yaml").write_text(said.spec)
    return read_spec(str(folder / "next.yaml"))


def test_what_was_named_is_told_from_what_explains_as_much(tmp_path: Path) -> None:
    rival = Hypothesis("a spring that stiffens", having(PAPER, one=CUBIC))
    found = physics("plant", "coulomb_friction")
    said = after(patched=having(PAPER, one=DRY), physics=(found,), rivals=(rival,))
    assert said.words.startswith("To tell dry friction from a spring that stiffens: a ")
    assert (
        "for 20 s; the two predictions of x1 then differ by" in said.words
        and "times the noise (" in said.words
    )
    assert said.gain is not None and said.gain > 1.0
    assert not spec_of(said, tmp_path).effects


def test_the_weakest_of_what_was_named_is_confirmed() -> None:
    both = physics("plant", "coulomb_friction", share=0.9), physics("plant", "cubic_stiffness", share=0.05)
    said = after(patched=having(PAPER, one=DRY, two=CUBIC), physics=both)
    assert said.words.startswith("To confirm cubic stiffness: ")
    assert "the predictions of x1 with and without it then differ by" in said.words and said.spec


@pytest.mark.parametrize(
    ("block", "kind", "told"),
    [
        ("link.tau1", "extra_delay", "spec's tau1"),
        ("link.tau2", "jitter", "tau2"),
        ("controller", "wrong_parameter", "actuator.stiffness differs"),
        ("sensor.position", "bias", "Rest x1"),
        ("sensor.acceleration", "scale", "Turn the accelerometer of x1 over"),
        ("motor", "lag", "Step the command"),
    ],
)
def test_software_sensors_and_drives_get_their_own_advice(block: str, kind: str, told: str) -> None:
    entry = {"name": "actuator.stiffness"} if block == "controller" else {}
    found = physics(block, kind, "x1", value=Value(41.0, 0.0, "1"), **entry)
    said = after(physics=(found,))
    assert told in said.words and said.spec is None and said.gain is None


def test_every_kind_and_every_fault_has_advice() -> None:
    for block in BLOCKS:
        for kind in kinds(block):
            assert effect(kind, block).experiment
            words = after(DECAY, physics=(physics(block, kind),)).words
            assert "{" not in words and words.endswith(".")
    for kind in (*FAULT, "new"):
        assert "{" not in fault_advice(kind, "x1.velocity")


def test_a_fault_comes_before_anything_else() -> None:
    fault = Fault("sensor.velocity", "sign", "x1.velocity", "words")
    said = after(faults=(fault,), physics=(physics("plant", "coulomb_friction"),))
    assert "x1.velocity" in said.words and said.spec is None


def test_a_new_value_is_measured_more_sharply(tmp_path: Path) -> None:
    retuned = {
        "plant.mass": Retuned(1.2, 1.21, 0.001, "kg"),
        "plant.damping": Retuned(0.05, 0.08, 0.004, "N s/m"),
    }
    patched = apply(PAPER, {"plant.mass": 1.21, "plant.damping": 0.08})
    said = after(verdict="retuned", patched=patched, retuned=retuned)
    assert said.words.startswith("To know plant.damping better: ")
    assert "its standard deviation then falls to about" in said.words
    assert spec_of(said, tmp_path).plant.mass == PAPER.plant.mass


def test_where_nothing_is_missing_smaller_effects_come_into_sight() -> None:
    cubic = {"plant.cubic_stiffness.coefficient": Limit(0.1, "N/m^3")}
    limits = {"plant.coulomb_friction.force": Limit(0.004, "N")} | cubic
    said = after(verdict="match", limits=limits)
    assert "cubic stiffness then shows from about" in said.words
    assert "(0.1 N/m^3 in this recording)" in said.words and said.spec
    assert after(verdict="match").spec is None


@pytest.mark.parametrize(("limits", "factor"), [({}, 2.0), ({"command": 0.6}, 0.5)])
def test_what_nobody_explains_is_repeated_at_another_amplitude(
    limits: dict[str, float], factor: float, tmp_path: Path
) -> None:
    nominal = apply(PAPER, {"limits": limits}) if limits else PAPER
    said = after(nominal, "unexplained")
    assert "at half and at twice the amplitude" in said.words and said.gain is None
    assert spec_of(said, tmp_path) == apply(nominal, {"plant.initial_position": 0.5 * factor})


def test_a_repetition_whose_force_nobody_wrote_down_is_words_only() -> None:
    assert after(apply(DECAY, {"plant.initial_position": 0.0}), "improved").spec is None
