"""Ages between hosts whose clocks differ are corrected by what was measured."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rthm_analysis.energy import energy_of
from rthm_analysis.recording import Recording, read_recording
from rthm_analysis.recording.synchronised import synchronised
from rthm_analysis.timing import TimingResult, timing_of
from rthm_core.spec import shipped_spec
from rthm_core.topics import LINKS

from .conftest import START, Message, joint_state, mcap_file
from .loop import empty_states, links, recorded, stamps

SPEC = shipped_spec()
WHEN = stamps(SPEC, 4.0)
SIGN = {"tau1": 0, "tau2": -1, "tau3": 1, "tau4": 0}
"""Which way a lead of the numerical node's clock changes what stamps hide of an age."""


def told(offset: float, drift: float = 0.0) -> list[Message]:
    """Messages on the clock of the numerical node, twice a second from before the start on."""
    return [
        joint_state("/rthm/clocks", START + at, ("numerical",), (offset + drift * at / 1e9,), (), (1e-4,))
        for at in range(-1_000_000_000, 4_500_000_000, 500_000_000)
    ]


def timing(tmp_path: Path, *clocks: Message) -> TimingResult:
    messages = [*empty_states(SPEC, WHEN), *links(SPEC, WHEN), *clocks]
    recording = read_recording(mcap_file(tmp_path / "x.mcap", messages))
    return timing_of(recording, SPEC)


def test_a_clock_that_leads_hides_a_part_of_the_age_that_is_given_back(tmp_path: Path) -> None:
    right, wrong = timing(tmp_path), timing(tmp_path, *told(0.003))
    assert wrong.links["tau3"].age == pytest.approx(0.015, abs=1e-9)
    for name in LINKS:
        np.testing.assert_allclose(
            wrong.links[name].age - right.links[name].age, SIGN[name] * 0.003, atol=2e-9
        )
        np.testing.assert_allclose(
            wrong.links[name].excess, right.links[name].excess + SIGN[name] * 0.003, atol=2e-9
        )
        assert (wrong.links[name].late, wrong.links[name].lost) == (0, 0)


def test_the_age_follows_a_clock_that_drifts(tmp_path: Path) -> None:
    tau3 = timing(tmp_path, *told(0.001, drift=500e-6)).links["tau3"]
    made = tau3.use - 0.012  # by the clock that leads, as its lead is then
    np.testing.assert_allclose(tau3.age, 0.012 + (0.001 + 500e-6 * made) / (1.0 + 500e-6), atol=1e-8)


def test_what_was_measured_is_told_and_without_it_nothing_is(tmp_path: Path) -> None:
    hosts = timing(tmp_path, *told(0.001, drift=500e-6)).as_dict()["hosts"]
    assert hosts == {
        "numerical": pytest.approx(
            {"offset": 0.00175, "least": 0.0005, "most": 0.003, "drift": 500e-6, "uncertainty": 1e-4}
        )
    }
    assert timing(tmp_path).as_dict()["hosts"] == {}


def behind_a_clock_that_leads(recording: Recording, lead: int) -> Recording:
    """The same test as the stamps of a numerical node show it whose clock leads by `lead`, ns."""
    tables, uses = dict(recording.tables), dict(recording.links)
    for name in ("numerical/state", "numerical/force_reference"):
        tables[name] = replace(tables[name], stamp_ns=tables[name].stamp_ns + lead)
    uses["tau2"] = replace(uses["tau2"], use_ns=uses["tau2"].use_ns + lead)
    uses["tau3"] = replace(uses["tau3"], sample_ns=uses["tau3"].sample_ns + lead)
    return replace(recording, tables=tables, links=uses)


def test_the_energy_balance_over_clocks_that_differ_is_that_of_the_test(tmp_path: Path) -> None:
    clocks = read_recording(mcap_file(tmp_path / "c.mcap", [*empty_states(SPEC, WHEN), *told(0.003)])).clocks
    right = read_recording(mcap_file(tmp_path / "x.mcap", recorded(SPEC, 3.0)))
    seen = behind_a_clock_that_leads(right, 3_000_000)
    assert synchronised(right) is right
    balance, told_right = energy_of(right, SPEC), energy_of(replace(seen, clocks=clocks), SPEC)
    np.testing.assert_array_equal(told_right.t, balance.t)
    for name, work in balance.work.items():
        np.testing.assert_array_equal(told_right.work[name], work)
    wrong = energy_of(seen, SPEC)
    error = abs(wrong.work["E_num"][-1] - balance.work["E_num"][-1])
    assert error > 0.01 * abs(balance.work["E_num"][-1])
