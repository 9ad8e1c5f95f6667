from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.diagnosis.computed import diagnose_computed
from rthm_analysis.diagnosis.computed.structure import structure
from rthm_analysis.diagnosis.diagnose import command_before
from rthm_analysis.diagnosis.result import Part
from rthm_analysis.recording import Recording, Table, read_recording
from rthm_core.numerical import NumericalSide
from rthm_core.physical.side import first_command
from rthm_core.spec import Spec, apply, shipped_spec

from .conftest import rosbag2
from .loop import recorded

DURATION = 6.0
PAPER = shipped_spec("paper_noisy")
THREE = shipped_spec("three_mass")


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("bags")


def test_of(folder: Path, spec: Spec) -> Recording:
    """What is recorded of a test in which everybody goes by `spec`."""
    return read_recording(rosbag2(folder / str(len(list(folder.iterdir()))), recorded(spec, DURATION)))


@pytest.fixture(scope="module")
def exact(folder) -> Recording:
    return test_of(folder, PAPER)


test_of.__test__ = False


def names(part: Part) -> list[tuple[str, str]]:
    return [(one.block, str(one.parameters["name"])) for one in part.physics]


def changed(one: Recording, topic: str, **columns: np.ndarray) -> Recording:
    return replace(one, tables=one.tables | {topic: replace(one.tables[topic], **columns)})


def thinned(table: Table, share: float, seed: int) -> Table:
    kept = np.random.default_rng(seed).random(len(table)) >= share
    kept[0] = True
    return table.rows(np.flatnonzero(kept))


def test_blocks_that_compute_what_the_spec_says_are_exact(exact):
    part = diagnose_computed(exact, PAPER)
    assert not part.physics and not part.unexplained and not part.notes
    assert [(one.block, one.significant) for one in part.blocks] == [
        ("numerical", False),
        ("controller", False),
    ]
    assert all(one.mismatch < 1e-6 for one in part.blocks)


def test_every_parameter_has_a_detection_limit_far_below_its_value(exact):
    limits = diagnose_computed(exact, PAPER).detection_limits
    assert limits["numerical.wrong_parameter.numerical.mass"].value < 1e-3 * PAPER.numerical.mass[0]
    assert limits["controller.wrong_parameter.actuator.stiffness"].value < 1e-3 * PAPER.k_tot[0]
    assert len(limits) == 6


@pytest.mark.parametrize(
    ("spec", "name", "factor"),
    [
        (PAPER, "numerical.mass", 1.004),
        (PAPER, "numerical.damping", 1.3),
        (PAPER, "interface.damping", 0.9),
        (THREE, "numerical.stiffness[3]", 1.01),
        (THREE, "interface.stiffness[1]", 0.97),
    ],
    ids=lambda one: one if isinstance(one, str) else "",
)
def test_a_wrong_parameter_of_the_numerical_substructure_is_named_with_its_value(folder, spec, name, factor):
    entry, _, index = name.rstrip("]").partition("[")
    section, key = entry.split(".")
    nominal = getattr(getattr(spec, section), key)[int(index or 0)]
    part = diagnose_computed(test_of(folder, apply(spec, {name: factor * nominal})), spec)
    assert names(part) == [("numerical", name)]
    assert part.physics[0].parameters["value"].value == pytest.approx(factor * nominal, rel=1e-6)
    assert part.effects[0]["parameters"] == {
        "name": name,
        "value": part.physics[0].parameters["value"].value,
    }
    fit = part.fits[0].nrmse
    assert fit["explained"] < fit["noise_floor"] < fit["nominal"]
    assert not part.unexplained


@pytest.mark.parametrize(("spec", "name"), [(PAPER, "actuator.stiffness"), (THREE, "actuator.stiffness[1]")])
def test_a_wrong_stiffness_in_the_controller_is_named_with_its_value(folder, spec, name):
    right = spec.k_tot[-1]
    part = diagnose_computed(test_of(folder, apply(spec, {name: 1.003 * right})), spec)
    assert names(part) == [("controller", name)]
    assert part.physics[0].parameters["value"].value == pytest.approx(1.003 * right, rel=1e-8)


def test_both_blocks_wrong_at_once_are_both_named(folder):
    true = apply(PAPER, {"numerical.stiffness": 6.1, "numerical.mass": 1.52, "actuator.stiffness": 40.5})
    part = diagnose_computed(test_of(folder, true), PAPER)
    assert set(names(part)) == {
        ("numerical", "numerical.stiffness"),
        ("numerical", "numerical.mass"),
        ("controller", "actuator.stiffness"),
    }


def test_the_patched_spec_leaves_nothing_to_find(folder):
    one = test_of(folder, apply(PAPER, {"numerical.mass": 1.47}))
    effect = diagnose_computed(one, PAPER).effects[0]
    section = {"block": effect["block"], "kind": effect["kind"], **effect["parameters"]}
    patched = apply(PAPER, {"effects": ["found"], "found": section})
    assert not diagnose_computed(one, patched).physics


def test_samples_missing_in_the_recording_leave_the_rest_to_be_checked(folder):
    one = test_of(folder, apply(PAPER, {"numerical.damping": 0.07}))
    topics = ("plant/state", "numerical/state", "numerical/force_reference", "actuator/command")
    tables = {topic: thinned(one.tables[topic], 0.1, i) for i, topic in enumerate(topics)}
    part = diagnose_computed(replace(one, tables=one.tables | tables), PAPER)
    assert names(part) == [("numerical", "numerical.damping")]


def test_links_that_are_not_recorded_are_taken_from_the_schedule_and_that_is_said(exact):
    part = diagnose_computed(replace(exact, links={}), PAPER)
    assert not part.physics
    assert len(part.notes) == 2 and "exact schedule" in part.notes[0]


@pytest.mark.parametrize("topic", ["numerical/state", "actuator/command"])
def test_a_block_that_is_not_recorded_is_said_to_be_unchecked(exact, topic):
    part = diagnose_computed(
        replace(exact, tables={k: v for k, v in exact.tables.items() if k != topic}), PAPER
    )
    assert f"{topic} is not recorded" in part.notes[0]
    assert len(part.blocks) == 1


def test_a_controller_with_an_offset_is_described_and_not_named(exact):
    u_d = 1.01 * exact.tables["actuator/command"].position + 0.002
    part = diagnose_computed(changed(exact, "actuator/command", position=u_d), PAPER)
    assert not part.physics
    assert "1.01 x1" in part.unexplained[0] and "+0.002 m" in part.unexplained[0]


def test_a_numerical_substructure_with_dry_friction_is_unexplained(exact):
    table = exact.tables["numerical/state"]
    friction = 0.01 * np.cumsum(np.sign(table.velocity), axis=0)
    part = diagnose_computed(changed(exact, "numerical/state", velocity=table.velocity - friction), PAPER)
    assert not any(one.share > 0.99 for one in part.physics)
    assert "does not compute what the spec says" in part.unexplained[0]


def test_a_controller_that_clips_few_commands_still_shows_its_stiffness(folder):
    one = test_of(folder, apply(PAPER, {"actuator.stiffness": 41.0}))
    u_d = one.tables["actuator/command"].position
    limit = float(np.quantile(np.abs(u_d), 0.97))
    part = diagnose_computed(changed(one, "actuator/command", position=np.clip(u_d, -limit, limit)), PAPER)
    assert names(part) == [("controller", "actuator.stiffness")]


def test_loads_of_nan_count_as_zero(exact):
    table = exact.tables["numerical/state"]
    part = diagnose_computed(
        changed(exact, "numerical/state", effort=np.full_like(table.effort, np.nan)), PAPER
    )
    assert not part.physics and not part.unexplained


def test_the_step_is_that_of_the_numerical_substructure():
    spec = apply(THREE, {"load.numerical": {"dof": "y1", "kind": "constant", "force": 0.7}})
    side, one = NumericalSide(spec), structure(spec)
    held = np.array([0.1, -0.2, 0.3, 0.05])
    side.latch(held[:2], held[2:])
    start = np.concatenate([side.position, side.velocity])
    side.advance(9_000_000)
    step = one.step(0.009)
    load = np.zeros(one.mass.shape[0])
    load[0] = 0.7
    predicted = step.state @ start + step.held @ held + step.load[0] @ load
    assert predicted == pytest.approx(np.concatenate([side.position, side.velocity]), abs=1e-14)
    assert one.force(held[None], predicted[None])[0] == pytest.approx(side.force_reference(), abs=1e-13)


def test_a_plant_alone_computes_nothing(exact):
    alone = apply(PAPER, dict.fromkeys(("numerical", "interface", "actuator", "timing", "load", "limits")))
    assert diagnose_computed(exact, alone) == Part()


def test_a_wrong_stiffness_of_the_controller_also_shows_in_the_command_before_the_test(folder):
    wrong = apply(
        PAPER,
        {
            "effects": ["wrong"],
            "wrong": {
                "block": "controller",
                "kind": "wrong_parameter",
                "name": "actuator.stiffness",
                "value": 0.85 * PAPER.k_tot[0],
            },
        },
    )
    part = diagnose_computed(test_of(folder, wrong), PAPER)
    assert command_before([part], PAPER) == pytest.approx(first_command(wrong), abs=1e-6)
    assert abs(first_command(wrong) - first_command(PAPER)) > 1e-3
