"""Times in the spec that are not those of the test, and links that are faster than they should be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.diagnose import diagnose
from rthm_analysis.diagnosis.links import diagnose_links
from rthm_analysis.diagnosis.physical.drives import choose_drives
from rthm_analysis.diagnosis.replay.evidence import gather
from rthm_analysis.diagnosis.search.starts import InitialGuess
from rthm_analysis.recording import Recording, hold, read_recording
from rthm_core.errors import InputError
from rthm_core.physical.side import first_command
from rthm_core.spec import Spec, apply, shipped_spec

from .conftest import rosbag2
from .loop import recorded
from .loops import paper, recording, stalled
from .test_diagnosis_links import found, told_later, with_effect

PAPER = shipped_spec("paper_noisy")
FIELDS = ("position", "velocity", "effort")
LINKS = ("tau1", "tau2", "tau3", "tau4")


def run_with(true: Spec, **more: object) -> Recording:
    """A test whose bag holds the spec that it was run with."""
    return replace(recording(true), spec=true, **more)  # type: ignore[arg-type]


def told(part):
    return [(one.block, one.kind, one.channel) for one in part.faults]


@pytest.mark.parametrize("link", LINKS)
def test_a_link_faster_than_the_spec_says_has_a_negative_delay(link):
    part = diagnose_links(recording(with_effect(paper(), link, "extra_delay", delay=-0.002)), paper())
    assert found(part) == [(f"link.{link}", "extra_delay")] and not part.faults
    value = part.physics[0].parameters["delay"]
    assert abs(value.value + 0.002) < 4.0 * value.std
    assert "earlier than the spec says" in part.physics[0].words
    assert f"Compare timing.{link}" in part.physics[0].words
    clocks = next(one for one in part.alternatives if one.kind == "clock_offset")
    assert not clocks.distinguishable


def test_clocks_that_disagree_look_the_same_where_the_stamps_do_not_show_it():
    part = diagnose_links(recording(with_effect(paper(), "tau4", "clock_offset", offset=-0.002)), paper())
    assert found(part) == [("link.tau4", "extra_delay")]
    assert part.physics[0].parameters["delay"].value == pytest.approx(-0.002, abs=1e-6)
    assert ("link.tau4", "clock_offset") in [(one.block, one.kind) for one in part.alternatives]


@pytest.mark.parametrize("share", [0.8, 1.2])
@pytest.mark.parametrize("link", LINKS)
def test_another_tau_than_that_of_the_test_is_a_fault_of_the_spec(link, share):
    true = getattr(paper().timing, link)
    part = diagnose_links(run_with(paper()), apply(paper(), {f"timing.{link}": share * true}))
    assert told(part) == [(f"link.{link}", "wrong_parameter", f"timing.{link}")]
    assert not part.physics
    assert part.faults[0].value == true and part.changes == {f"timing.{link}": true}
    assert "Compare the timing section of the spec" in part.faults[0].words
    assert [one.block for one in part.blocks if one.significant] == [f"link.{link}"]


def test_a_bag_whose_spec_the_uses_deny_is_not_believed():
    wrong = apply(paper(), {"timing.tau4": 0.012})
    assert diagnose_links(replace(recording(paper()), spec=wrong), paper()).faults == ()
    part = diagnose_links(replace(recording(paper()), spec=wrong), wrong)
    assert found(part) == [("link.tau4", "extra_delay")] and not part.faults


def test_loss_beside_a_wrong_tau_is_still_found():
    lossy = with_effect(paper(), "tau2", "loss", fraction=0.04)
    part = diagnose_links(run_with(lossy), apply(paper(), {"timing.tau2": 0.0095}))
    assert told(part) == [("link.tau2", "wrong_parameter", "timing.tau2")]
    assert found(part) == [("link.tau2", "loss")]


def test_a_tau_whose_uses_are_not_recorded_is_taken_from_the_spec_of_the_test():
    one = run_with(paper())
    links = {name: link for name, link in one.links.items() if name != "tau4"}
    part = diagnose_links(replace(one, links=links), apply(paper(), {"timing.tau4": 0.012}))
    assert told(part) == [("link.tau4", "wrong_parameter", "timing.tau4")]
    assert "cannot confirm" in part.faults[0].words


@pytest.mark.parametrize(
    ("name", "wrong"),
    [("td1", 0.001), ("td2", 0.013), ("td3", 0.005), ("td3", 0.008), ("td3", 0.002), ("td4", 0.003)],
)
@pytest.mark.parametrize("known", [True, False])
def test_another_period_than_that_of_the_test_is_a_fault_of_the_spec(name, wrong, known):
    one = run_with(paper()) if known else recording(paper())
    part = diagnose_links(one, apply(paper(), {f"timing.{name}": wrong}))
    assert [(fault.kind, fault.channel) for fault in part.faults] == [("wrong_parameter", f"timing.{name}")]
    assert part.changes == {f"timing.{name}": getattr(paper().timing, name)}
    assert not part.physics
    assert ("as the spec in the recording says" in part.faults[0].words) == known


def test_references_taken_over_on_a_clock_that_the_spec_does_not_have():
    clocked = apply(paper(), {"timing.td4": 0.003})
    part = diagnose_links(recording(clocked), paper())
    assert [fault.channel for fault in part.faults] == ["timing.td4"]
    assert part.faults[0].value == 0.003


def test_every_other_sample_recorded_is_no_other_clock():
    one = recording(paper())
    table = one.plant.rows(np.arange(0, len(one.plant), 2))
    part = diagnose_links(replace(one, tables=one.tables | {"plant/state": table}), paper())
    assert not part.faults


def test_a_busy_machine_and_missing_samples_are_no_fault_of_the_spec():
    random = np.random.default_rng(4)
    one = run_with(paper())
    for name in one.links:
        one = told_later(one, name, 1e5 * random.lognormal(0.0, 0.7, len(one.links[name])))
    for topic, table in one.tables.items():
        rows = np.union1d(0, np.flatnonzero(random.random(len(table)) > 0.08))
        one = replace(one, tables=one.tables | {topic: table.rows(rows)})
    assert not diagnose_links(one, paper()).faults
    assert not diagnose_links(stalled(run_with(paper()), paper(), 7, 400), paper()).faults


# Motors, names, and uses that are told late


@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    """A test whose motors follow at once, with their positions."""
    one = read_recording(rosbag2(tmp_path_factory.mktemp("driven") / "bag", recorded(PAPER, 6.0)))
    sent, uses = one.tables["actuator/command"], one.links["tau4"]
    used = hold(sent.stamp_ns, sent.position, uses.sample_ns)
    position = one.plant.position.copy()
    moved = one.plant.stamp_ns >= uses.use_ns[0]
    noise = 1e-5 * np.random.default_rng(2).normal(size=position.shape[0])
    position[:, 1] = np.where(moved, hold(uses.use_ns, used, one.plant.stamp_ns)[:, 0], first_command(PAPER))
    position[:, 1] += noise
    return replace(one, tables=one.tables | {"plant/state": replace(one.plant, position=position)})


def drives(one: Recording, spec: Spec) -> list[InitialGuess]:
    chosen = choose_drives(gather(one, spec).only("motor"), spec, first_command(spec))
    return [tried[0].start for tried in chosen.rounds]


def is_early(starts: list[InitialGuess], by: float) -> bool:
    """Whether a motor answers earlier, up to the uncertainty of the start."""
    (start,) = starts
    uncertainty = start.scales["delay"] + 1e-6
    return (
        start.added.kind == "extra_delay" and abs(start.added.parameters["delay"] + by) < uncertainty < 1e-3
    )


LONGER = apply(PAPER, {"timing.tau4": PAPER.timing.tau4 + 0.002})


def test_a_motor_that_answers_earlier_than_its_uses_say_has_a_negative_delay(driven):
    link = driven.links["tau4"]
    told = replace(driven, links=driven.links | {"tau4": replace(link, use_ns=link.use_ns + 2_000_000)})
    assert is_early(drives(told, LONGER), 0.002)


def test_without_uses_a_motor_is_compared_with_the_specs_delay(driven):
    links = {name: link for name, link in driven.links.items() if name != "tau4"}
    assert not drives(replace(driven, links=links), PAPER)
    assert is_early(drives(replace(driven, links=links), LONGER), 0.002)


def test_motors_that_keep_to_the_spec_have_no_delay(driven):
    assert not drives(driven, PAPER)


def test_uses_told_a_little_late_are_no_delay_behind_a_compensator(tmp_path):
    spec = apply(PAPER, {"actuator.compensator": "taylor"})
    one = read_recording(rosbag2(tmp_path / "bag", recorded(spec, 6.0)))
    random = np.random.default_rng(2)
    for name in ("tau1", "tau2", "tau3"):
        one = told_later(one, name, 2_300 + 1e5 * random.lognormal(0.0, 0.7, len(one.links[name])))
    part = diagnose_links(one, spec)
    assert not part.physics and not part.faults


@pytest.mark.parametrize(
    ("spec", "sentence"),
    [
        (apply(PAPER, {"actuator.names": "b1"}), "x1, a1 in plant/state, but not b1 of the spec"),
        (
            apply(
                PAPER,
                {"numerical.dofs": "y1", "interface.numerical_dof": "y1", "load.numerical.dof": "y1"},
            ),
            "x2 in numerical/state, but not y1 of the spec",
        ),
        (shipped_spec("three_mass"), "use the spec of this test"),
    ],
)
def test_names_of_another_rig_are_refused_at_once(driven, spec, sentence):
    with pytest.raises(InputError, match=sentence):
        diagnose(driven, spec)


def test_more_parts_than_the_spec_has_are_refused(driven):
    table = driven.tables["numerical/state"]
    twice = replace(table, names=("x2", "x3"), **{f: np.hstack([getattr(table, f)] * 2) for f in FIELDS})
    with pytest.raises(InputError, match="x2, x3 in numerical/state, but the spec has only x2"):
        diagnose(replace(driven, tables=driven.tables | {"numerical/state": twice}), PAPER)


def test_a_plant_that_nothing_is_known_to_drive_is_refused(driven):
    tables = {name: table for name, table in driven.tables.items() if name != "actuator/command"}
    blind = replace(driven.plant, effort=np.full_like(driven.plant.effort, np.nan))
    with pytest.raises(InputError, match="neither actuator/command nor forces of a1"):
        diagnose(replace(driven, tables=tables | {"plant/state": blind}), PAPER)
