"""A spec of which hardly anything agrees with what the loop did is that of another test."""

from __future__ import annotations

from rthm_analysis.diagnosis.faults.other_loop import find_other_loop
from rthm_analysis.diagnosis.result import Fault, Mismatch, Part, Physics


def late(*links: str) -> Part:
    return Part(physics=tuple(Physics(f"link.{one}", "extra_delay", None, {}, "", 0.0, 1.0) for one in links))


def computing(*blocks: str) -> Part:
    return Part(blocks=tuple(Mismatch(one, 9.0, True) for one in blocks))


def other(entry: str) -> Part:
    return Part(faults=(Fault("plant", "wrong_parameter", f"timing.{entry}", ""),))


def test_other_delays_periods_and_blocks_together_are_another_loop() -> None:
    (fault,) = find_other_loop([late("tau1", "tau2"), other("td1"), computing("controller", "numerical")])
    assert fault.kind == "wrong_spec"
    for name in ("timing.td1", "timing.tau1", "timing.tau2", "the controller", "the numerical substructure"):
        assert name in fault.words


def test_a_slow_network_or_a_few_wrong_entries_are_the_same_loop() -> None:
    assert not find_other_loop([late("tau1", "tau2", "tau3", "tau4"), other("td1")])
    assert not find_other_loop([late("tau1"), other("tau1"), other("td2"), computing("controller")])
    assert not find_other_loop([Part(blocks=(Mismatch("controller", 1.0, False),)), late("tau1", "tau2")])
