"""A controller with another compensator than the spec's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.computed import diagnose_computed
from rthm_analysis.diagnosis.diagnose import command_before
from rthm_analysis.diagnosis.links import diagnose_links
from rthm_core.physical.side import first_command
from rthm_core.spec import apply

from .test_diagnosis_computed import PAPER, THREE, changed, folder, names, test_of  # noqa: F401

NONE: dict[str, object] = {"actuator.compensator": "none"}
TAYLOR: dict[str, object] = {"actuator.compensator": "taylor"}
POLYNOMIAL: dict[str, object] = {"actuator.compensator": "polynomial"}
THIRD = POLYNOMIAL | {"actuator.compensator_order": 3}
OTHER = [("controller", "wrong_parameter", "actuator.compensator")]


def unknown(one):
    """The same recording without the spec of the test."""
    return replace(one, spec=None)


def channels(part):
    return [(one.block, one.kind, one.channel) for one in part.faults]


@pytest.mark.parametrize("spec", [PAPER, THREE], ids=["paper", "three"])
@pytest.mark.parametrize("entries", [TAYLOR, THIRD], ids=["taylor", "third"])
def test_commands_of_the_specs_compensator_are_exact(folder, spec, entries):  # noqa: F811
    true = apply(spec, entries)
    one = test_of(folder, true)
    part = diagnose_computed(one, true)
    assert not part.faults and not part.physics and not part.unexplained and not part.notes
    controller = part.blocks[1]
    assert controller.block == "controller" and controller.mismatch < 1e-6
    assert not diagnose_links(one, true).physics


@pytest.mark.parametrize(
    ("true", "said", "wrong"),
    [
        (NONE, TAYLOR, {"compensator": "none"}),
        (NONE, POLYNOMIAL, {"compensator": "none"}),
        (TAYLOR, NONE, {"compensator": "taylor"}),
        (TAYLOR, POLYNOMIAL, {"compensator": "taylor"}),
        (POLYNOMIAL, NONE, {"compensator": "polynomial"}),
        (THIRD, POLYNOMIAL, {"compensator_order": 3}),
        (TAYLOR | {"actuator.compensator_horizon": 0.007}, TAYLOR, {"compensator_horizon": 0.007}),
        (
            POLYNOMIAL,
            POLYNOMIAL | {"actuator.compensator_horizon": 0.02},
            {"compensator_horizon": None},
        ),
        (
            THIRD | {"actuator.compensator_horizon": 0.0123},
            NONE,
            {"compensator": "polynomial", "compensator_order": 3, "compensator_horizon": 0.0123},
        ),
    ],
)
def test_another_compensator_than_the_specs_is_a_fault_of_the_spec(folder, true, said, wrong):  # noqa: F811
    one, spec = unknown(test_of(folder, apply(PAPER, true))), apply(PAPER, said)
    part = diagnose_computed(one, spec)
    assert channels(part) == [("controller", "wrong_parameter", f"actuator.{name}") for name in wrong]
    for fault, value in zip(part.faults, wrong.values(), strict=True):
        assert fault.value == (value if isinstance(value, int | float) else None)
        assert "Compare the actuator section" in fault.words
    assert not part.physics and not part.unexplained
    assert part.blocks[1].significant and part.blocks[1].mismatch > 1.0
    assert not diagnose_links(one, spec).physics
    assert command_before([part], spec) == pytest.approx(first_command(apply(PAPER, true)))


def test_words_say_both_what_the_spec_says_and_what_the_commands_are(folder):  # noqa: F811
    part = diagnose_computed(unknown(test_of(folder, PAPER)), apply(PAPER, TAYLOR))
    assert part.faults[0].words.startswith(
        "The spec says actuator.compensator: taylor, but the recorded commands are those of a controller "
        "without a compensator."
    )


def test_a_wrong_stiffness_behind_a_wrong_compensator_is_still_named(folder):  # noqa: F811
    true = apply(PAPER, TAYLOR | {"actuator.stiffness": 41.0})
    part = diagnose_computed(unknown(test_of(folder, true)), PAPER)
    assert channels(part) == OTHER
    assert names(part) == [("controller", "actuator.stiffness")]
    assert part.physics[0].parameters["value"].value == pytest.approx(41.0, rel=1e-6)


@pytest.mark.parametrize("said", [NONE, TAYLOR], ids=["none", "taylor"])
def test_commands_of_no_known_compensator_are_not_passed_over(folder, said):  # noqa: F811
    one = test_of(folder, apply(PAPER, TAYLOR))
    u_d = 0.95 * one.tables["actuator/command"].position
    part = diagnose_computed(changed(one, "actuator/command", position=u_d), apply(PAPER, said))
    assert not part.faults and not part.physics
    assert part.blocks[1].significant and part.unexplained


def test_samples_missing_in_the_recording_leave_the_compensator_to_be_checked(folder):  # noqa: F811
    one = unknown(test_of(folder, apply(PAPER, TAYLOR)))
    random = np.random.default_rng(3)
    for topic in ("plant/state", "actuator/command", "numerical/force_reference"):
        rows = np.union1d(0, np.flatnonzero(random.random(len(one.tables[topic])) > 0.03))
        one = replace(one, tables=one.tables | {topic: one.tables[topic].rows(rows)})
    assert not diagnose_computed(one, apply(PAPER, TAYLOR)).faults
    assert channels(diagnose_computed(one, PAPER)) == [
        ("controller", "wrong_parameter", "actuator.compensator")
    ]


def test_without_uses_a_compensator_is_said_to_be_unchecked(folder):  # noqa: F811
    one, spec = test_of(folder, apply(PAPER, TAYLOR)), apply(PAPER, TAYLOR)
    part = diagnose_computed(replace(one, links={}), spec)
    assert any("not all recorded" in note for note in part.notes)


@pytest.mark.parametrize("link", ["tau1", "tau3"])
@pytest.mark.parametrize("delay", [-0.0025, 0.0025])
def test_links_with_other_delays_leave_the_compensator_what_it_is(folder, link, delay):  # noqa: F811
    spec = apply(PAPER, TAYLOR)
    effect = {"block": f"link.{link}", "kind": "extra_delay", "delay": delay}
    part = diagnose_computed(test_of(folder, apply(spec, {"effects": ["off"], "off": effect})), spec)
    assert not part.faults and not part.physics and not part.unexplained
    assert part.blocks[1].mismatch < 1e-6
