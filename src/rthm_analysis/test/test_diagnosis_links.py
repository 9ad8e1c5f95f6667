from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.links import diagnose_links
from rthm_analysis.diagnosis.replay.evidence import gather
from rthm_analysis.diagnosis.result import Part
from rthm_analysis.recording import LinkTable, Recording
from rthm_analysis.timing.links import clock_of
from rthm_core.schedule import Schedule
from rthm_core.spec import Spec, apply

from .loops import paper, recording, stalled, without_times_of_sending

SIZES = {"extra_delay": ("delay", 0.0011), "jitter": ("std", 0.0013), "loss": ("fraction", 0.04)}


def with_effect(spec: Spec, link: str, kind: str, **parameters: float) -> Spec:
    return apply(spec, {"effects": ["added"], "added": {"block": f"link.{link}", "kind": kind, **parameters}})


def told_later(one: Recording, name: str, late: np.ndarray) -> Recording:
    link = one.links[name]
    use = np.maximum.accumulate(link.use_ns + late.astype(np.int64))
    return replace(one, links=one.links | {name: replace(link, use_ns=use)})


def out_for(one: Recording, name: str, clocked: bool) -> Recording:
    """Nothing comes through a link from 4 s to 6 s: a clocked receiver uses what it had, another nothing."""
    link = one.links[name]
    out = (link.use_ns - one.start_ns > 4e9) & (link.use_ns - one.start_ns < 6e9)
    if clocked:
        held = np.where(out, link.sample_ns[np.flatnonzero(out)[0] - 1], link.sample_ns)
        return replace(one, links=one.links | {name: replace(link, sample_ns=held)})
    kept = LinkTable(*(column[~out] for column in vars(link).values()))
    return replace(one, links=one.links | {name: kept})


def found(part: Part) -> list[tuple[str, str]]:
    return [(one.block, one.kind) for one in part.physics]


@pytest.fixture(scope="module")
def exact() -> Part:
    return diagnose_links(recording(paper()), paper())


def test_an_exact_recording_has_nothing_wrong_with_its_links(exact):
    assert not exact.physics and not exact.notes
    assert [one.block for one in exact.blocks] == [f"link.tau{i}" for i in (1, 2, 3, 4)]
    assert all(one.mismatch == 1.0 and not one.significant for one in exact.blocks)


@pytest.mark.parametrize("link", ["tau1", "tau2", "tau4"])  # uses of tau3 are told by the commands as well
def test_a_link_that_is_out_for_a_while_is_told_with_its_time(link):
    spec = paper()
    out = out_for(recording(spec), link, clocked=bool(clock_of(link, Schedule(spec))[1]))
    part = diagnose_links(out, spec)
    assert [(one.block, one.kind) for one in part.faults] == [(f"link.{link}", "dropout")]
    assert part.faults[0].interval == pytest.approx((4.0, 6.0), abs=0.05)
    assert not part.physics


def test_every_link_and_kind_has_a_detection_limit(exact):
    assert len(exact.detection_limits) == 16
    assert all(0.0 < limit.value < 0.05 for limit in exact.detection_limits.values())


@pytest.mark.parametrize("kind", SIZES)
@pytest.mark.parametrize("link", ["tau1", "tau2", "tau3", "tau4"])
def test_what_is_wrong_with_a_link_is_named_with_its_size(link, kind):
    parameter, size = SIZES[kind]
    part = diagnose_links(recording(with_effect(paper(), link, kind, **{parameter: size})), paper())
    assert found(part) == [(f"link.{link}", kind)]
    value = part.physics[0].parameters[parameter]
    assert abs(value.value - size) < 4.0 * value.std
    assert value.std < 0.35 * size
    fit = part.fits[0].nrmse
    assert fit["explained"] < 1.3 * fit["noise_floor"] + 1e-6
    assert fit["explained"] < fit["nominal"]


def test_a_delay_under_clocks_that_hardly_ever_tick_alike_is_found_to_a_microsecond():
    clocks = {"timing.td1": 0.001657, "timing.td2": 0.006056, "timing.td3": 0.002822, "timing.tau1": 0.003428}
    spec = apply(paper(), clocks)
    part = diagnose_links(recording(with_effect(spec, "tau1", "extra_delay", delay=0.002126), 40.0), spec)
    assert found(part) == [("link.tau1", "extra_delay")]
    assert abs(part.physics[0].parameters["delay"].value - 0.002126) < 1e-6
    fit = part.fits[0].nrmse
    assert fit["explained"] < 1.3 * fit["noise_floor"] + 1e-6


def test_one_phase_between_clocks_leaves_loss_and_jitter_alike():
    # Td1 divides Td2, so the newest sample always has the same time to spare before a tick of Td2.
    part = diagnose_links(recording(with_effect(paper(), "tau2", "loss", fraction=0.015), 40.0), paper())
    jitter = next(one for one in part.alternatives if one.kind == "jitter")
    assert jitter.block == "link.tau2" and not jitter.distinguishable


@pytest.mark.parametrize("link", ["tau1", "tau2", "tau3", "tau4"])
def test_stamps_of_another_clock_are_a_clock_offset_and_no_delay(link):
    offset = 1_750_000
    one = recording(with_effect(paper(), link, "clock_offset", offset=offset * 1e-9))
    shifted = replace(one.links[link], sample_ns=one.links[link].sample_ns + offset)
    part = diagnose_links(replace(one, links=one.links | {link: shifted}), paper())
    assert found(part) == [(f"link.{link}", "clock_offset")]
    assert part.physics[0].parameters["offset"].value == pytest.approx(offset * 1e-9)


def test_a_clock_that_is_behind_does_not_mix_up_the_commands():
    plain = recording(paper())
    offset = -round(0.3 * paper().loop().timing.ns("td3"))
    shifted = replace(plain.links["tau4"], sample_ns=plain.links["tau4"].sample_ns + offset)
    mixed = replace(plain, links=plain.links | {"tau4": shifted})
    np.testing.assert_array_equal(gather(mixed, paper()).commands, gather(plain, paper()).commands)


def test_without_any_use_of_a_command_the_force_drives_the_plant():
    plain = recording(paper())
    unused = plain.links["tau4"].rows(np.empty(0, dtype=np.int64))
    evidence = gather(replace(plain, links=plain.links | {"tau4": unused}), paper())
    assert evidence.driven_by == "force" and "No commands are recorded" in evidence.notes[0]


def test_a_clock_offset_of_whole_periods_is_told_by_the_values_used():
    offset = 2 * paper().loop().timing.ns("td2")
    one = recording(with_effect(paper(), "tau3", "clock_offset", offset=offset * 1e-9))
    shifted = replace(one.links["tau3"], sample_ns=one.links["tau3"].sample_ns + offset)
    part = diagnose_links(replace(one, links=one.links | {"tau3": shifted}), paper())
    assert part.physics[0].parameters["offset"].value == pytest.approx(offset * 1e-9)


def test_uses_that_a_busy_machine_tells_late_are_no_physics():
    one, random = recording(paper()), np.random.default_rng(2)
    for name in one.links:
        late = 1e5 * random.lognormal(0.0, 0.7, len(one.links[name]))
        late[500:504] += 15e6
        one = told_later(one, name, late) if name != "tau4" else one
    part = diagnose_links(one, paper())
    assert not part.physics


def test_samples_that_come_exponentially_late_are_no_physics():
    one, random = recording(paper()), np.random.default_rng(3)
    for name in ("tau3", "tau4"):
        one = told_later(one, name, random.exponential(2e5, len(one.links[name])))
    assert not diagnose_links(one, paper()).physics


def test_two_kinds_on_one_link_are_both_found():
    both = apply(
        paper(),
        {
            "effects": ["late", "lost"],
            "late": {"block": "link.tau2", "kind": "extra_delay", "delay": 0.002},
            "lost": {"block": "link.tau2", "kind": "loss", "fraction": 0.08},
        },
    )
    part = diagnose_links(recording(both, 40.0), paper())
    assert found(part) == [("link.tau2", "extra_delay"), ("link.tau2", "loss")]


def test_samples_missing_in_the_recording_are_not_lost_on_the_link():
    one, random = recording(paper()), np.random.default_rng(4)
    for topic in ("plant/state", "numerical/force_reference"):
        rows = np.flatnonzero(random.random(len(one.tables[topic])) > 0.05)
        one = replace(one, tables=one.tables | {topic: one.tables[topic].rows(np.union1d(0, rows))})
    for name in ("tau1", "tau2", "tau3"):
        rows = np.flatnonzero(random.random(len(one.links[name])) > 0.05)
        one = replace(one, links=one.links | {name: one.links[name].rows(rows)})
    assert not diagnose_links(one, paper()).physics


def test_a_link_that_is_not_recorded_is_said_to_be_unchecked():
    one = recording(paper())
    part = diagnose_links(
        replace(one, links={n: link for n, link in one.links.items() if n != "tau2"}), paper()
    )
    assert "links/tau2 is not recorded" in part.notes[0]
    assert [block.block for block in part.blocks] == ["link.tau1", "link.tau3", "link.tau4"]


@pytest.mark.parametrize("kind", SIZES)
def test_a_spec_with_the_effect_that_was_found_leaves_nothing_to_find(kind):
    parameter, size = SIZES[kind]
    true = with_effect(paper(), "tau1", kind, **{parameter: size})
    assert not diagnose_links(recording(true), true).physics


def test_a_plant_alone_has_no_links():
    alone = apply(paper(), dict.fromkeys(("numerical", "interface", "actuator", "timing", "load")))
    assert diagnose_links(recording(paper()), alone) == Part()


def test_stalls_of_a_machine_are_neither_loss_nor_jitter():
    for seed in (5, 6):
        one = without_times_of_sending(stalled(recording(paper()), paper(), seed))
        assert not diagnose_links(one, paper()).physics


@pytest.mark.parametrize("times", [100, 400])
def test_a_machine_that_stands_still_often_is_seen_by_times_of_sending(times):
    part = diagnose_links(stalled(recording(paper()), paper(), 7, times), paper())
    assert not part.physics
    assert "stalled" in part.notes[0]


def test_loss_is_found_on_a_machine_that_stands_still_often():
    part = diagnose_links(stalled(recording(paper()), paper(), 8, 100, lost=0.04), paper())
    assert found(part) == [("link.tau1", "loss")]
    value = part.physics[0].parameters["fraction"]
    assert abs(value.value - 0.04) < 3.0 * value.std
