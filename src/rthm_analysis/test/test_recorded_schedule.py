"""A recorded test simulated along the delays that it had."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.timing import RecordedSchedule
from rthm_core.clock import to_ns
from rthm_core.engine import simulate, simulate_blocks
from rthm_core.errors import InputError
from rthm_core.spec import Spec, apply

from .loops import paper, recording

SECONDS = 6.0


def with_effects(**links: tuple[str, dict[str, float]]) -> Spec:
    """The paper's loop with one effect on each of some links."""
    sections = {
        name: {"block": f"link.{name}", "kind": kind, **parameters}
        for name, (kind, parameters) in links.items()
    }
    return apply(paper(), {"effects": list(sections), **sections})


TRUE = {
    "delays of the spec": paper(),
    "late state": with_effects(tau1=("extra_delay", {"delay": 0.0023})),
    "jitter everywhere": with_effects(**{f"tau{k}": ("jitter", {"std": 0.003}) for k in (1, 2, 3, 4)}),
    "samples lost": with_effects(**{f"tau{k}": ("loss", {"fraction": 0.1}) for k in (1, 2, 3, 4)}),
    "clock of the controller": apply(with_effects(tau3=("jitter", {"std": 0.004})), {"timing.td4": 0.002}),
    "late references": with_effects(tau3=("extra_delay", {"delay": 0.0071})),
}


@pytest.mark.parametrize("true", TRUE.values(), ids=TRUE.keys())
def test_a_recording_tells_the_delays_that_its_spec_does_not(true: Spec):
    told = apply(paper(), {"timing.td4": true.loop().timing.td4})
    schedule = RecordedSchedule(told, recording(true, SECONDS))
    repeated, recorded = simulate(told, SECONDS, schedule=schedule), simulate(true, SECONDS)
    assert np.abs(repeated.plant_position - recorded.plant_position).max() < 1e-12
    assert np.abs(repeated.force_reference - recorded.force_reference).max() < 1e-9
    assert np.abs(repeated.balance_error).max() < 1e-9


def test_physics_is_that_of_the_spec_and_delays_are_those_of_the_recording():
    true = TRUE["jitter everywhere"]
    heavier = {"plant.mass": [1.3]}
    schedule = RecordedSchedule(apply(paper(), heavier), recording(true, SECONDS))
    repeated = simulate(apply(paper(), heavier), SECONDS, schedule=schedule)
    assert np.allclose(
        repeated.plant_position, simulate(apply(true, heavier), SECONDS).plant_position, atol=1e-12
    )


def test_blocks_joined_are_the_trajectory():
    true = TRUE["samples lost"]
    schedule = RecordedSchedule(paper(), recording(true, SECONDS))
    blocks = list(simulate_blocks(paper(), SECONDS, schedule=schedule))
    assert np.array_equal(
        np.concatenate([block.plant_position for block in blocks]),
        simulate(paper(), SECONDS, schedule=schedule).plant_position,
    )


def test_a_late_reference_is_used_from_its_arrival_on():
    """What a controller tells of a stall: two references that arrive after it, got to at once."""
    one = recording(paper(), SECONDS)
    uses, commands = one.links["tau3"], one.tables["actuator/command"]
    number = 200
    due = uses.use_ns[number : number + 2]
    arrived = due[1] + np.array([5_100_001, 5_100_777])
    use = uses.use_ns.copy()
    use[number : number + 2] = arrived[1] + np.array([40_000, 90_000])
    moved = np.flatnonzero(np.isin(commands.stamp_ns, due))
    stamps = commands.stamp_ns.copy()
    stamps[moved] = arrived[2 - moved.size :]
    late = replace(
        one,
        links=one.links | {"tau3": replace(uses, use_ns=use)},
        tables=one.tables | {"actuator/command": replace(commands, stamp_ns=np.sort(stamps))},
    )
    schedule = RecordedSchedule(paper(), late)
    sent = schedule.commands(0, schedule.end)
    first = int(
        np.flatnonzero(
            sent.reference == sent.reference[np.searchsorted(sent.time, arrived[0] - one.start_ns)]
        )[0]
    )
    assert sent.time[first] == arrived[0] - one.start_ns


def test_ticks_that_the_controller_left_out_sent_no_command():
    one = recording(paper(), SECONDS)
    commands, arrived = one.tables["actuator/command"], one.links["tau4"]
    begin, end = one.start_ns + 2_000_000_000, one.start_ns + 2_050_000_000
    kept = (arrived.sample_ns < begin) | (arrived.sample_ns >= end)
    uses = {name: getattr(arrived, name)[kept] for name in ("use_ns", "sample_ns")}
    stalled = replace(
        one,
        links=one.links | {"tau4": replace(arrived, **uses)},
        tables=one.tables
        | {
            "actuator/command": commands.rows(
                np.flatnonzero((commands.stamp_ns < begin) | (commands.stamp_ns >= end))
            )
        },
    )
    schedule = RecordedSchedule(paper(), stalled)
    assert not schedule.commands(2_000_000_000, 2_050_000_000).time.size
    assert schedule.commands(2_050_000_000, 2_060_000_000).time.size


def test_a_tick_that_was_left_out_used_nothing_newer_than_the_next_one():
    """A stall of the controller, after which it takes a sample that was older than the delay."""
    one = recording(paper(), SECONDS)
    uses, left_out = one.links["tau1"], [200, 201]
    late = uses.sample_ns.copy()
    late[202] = late[199]
    kept = np.delete(np.arange(late.size), left_out)
    told = replace(uses, use_ns=uses.use_ns[kept], sample_ns=late[kept])
    stalled = replace(one, links=one.links | {"tau1": told})
    sent = RecordedSchedule(paper(), stalled).commands(0, to_ns(SECONDS))
    at = sent.state[np.searchsorted(sent.time, (uses.use_ns[199:204] - one.start_ns))]
    td1 = to_ns(paper().loop().timing.td1)
    assert at[3] == at[0] == (late[202] - one.start_ns) // td1
    assert at[1] == at[2] == at[0] < at[4]


def test_what_cannot_be_repeated_is_refused():
    one = recording(paper(), SECONDS)
    without = replace(one, links={name: uses for name, uses in one.links.items() if name != "tau2"})
    with pytest.raises(InputError, match="the recording has no tau2"):
        RecordedSchedule(paper(), without)
    with pytest.raises(InputError, match=r"timing.td2 is 0.02 s, in the recorded test it was"):
        RecordedSchedule(apply(paper(), {"timing.td2": 0.02}), replace(one, spec=paper()))
    with pytest.raises(InputError, match="longer than the recorded test"):
        simulate(paper(), SECONDS + 1.0, schedule=RecordedSchedule(paper(), one))
