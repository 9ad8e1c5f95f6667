"""Offsets between clocks, from exchanges over a network that takes any time."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rthm_core.clock import NS
from rthm_core.clocks import UNKNOWN, Comparison, Exchange, Offset, limit_of
from rthm_core.errors import InputError
from rthm_core.ros.wall import emulated
from rthm_core.spec import parameters as parameters_of
from rthm_core.spec import shipped_spec, spec_from_parameters

WAYS = st.integers(10_000, 20_000_000)


def exchange(at: int, offset: float, there: int, node: int, back: int) -> Exchange:
    """What is seen when both ways and the node take so long, ns."""
    lead = round(offset * NS)
    return Exchange(at, at + there + lead, at + there + node + lead, at + there + node + back)


@given(st.floats(-10.0, 10.0), WAYS, WAYS, WAYS)
def test_an_offset_is_never_further_off_than_its_uncertainty(
    offset: float, there: int, node: int, back: int
) -> None:
    one = exchange(10**18, offset, there, node, back)
    assert abs(one.offset - offset) <= one.uncertainty + 1e-9
    assert one.uncertainty == pytest.approx((there + back) / 2 / NS)


def test_the_quickest_of_the_last_exchanges_is_believed() -> None:
    compared = Comparison(window=0.5)
    assert compared.best() == UNKNOWN
    compared.add(exchange(0, 0.003, 30_000, 0, 30_000))
    compared.add(exchange(10**8, 0.003, 5_000_000, 0, 100_000))
    assert compared.best().offset == pytest.approx(0.003, abs=1e-9)
    compared.add(exchange(10**9, 0.004, 200_000, 0, 100_000))
    assert compared.best() == pytest.approx(Offset(0.00405, 0.00015, 10**9 + 150_000))


def test_a_drifting_clock_is_followed_within_its_drift_over_the_window() -> None:
    compared, drift = Comparison(window=0.5), 500e-6
    for at in range(0, 10 * NS, NS // 20):
        compared.add(exchange(at, drift * at / NS, 100_000, 50_000, 200_000))
        assert compared.best().offset == pytest.approx(drift * at / NS, abs=drift * 0.5 + 100e-6)


def test_an_offset_is_beyond_a_limit_only_when_that_is_certain() -> None:
    assert Offset(-0.003, 0.001, 0).beyond(0.0019)
    assert not Offset(-0.003, 0.001, 0).beyond(0.0021)
    assert not UNKNOWN.beyond(0.001)


def test_a_tenth_of_the_shortest_delay_is_allowed_unless_the_spec_says_otherwise() -> None:
    assert limit_of(shipped_spec()) == pytest.approx(0.0004)
    paper = {entry.name: entry.value for entry in parameters_of(shipped_spec())}
    assert limit_of(spec_from_parameters(paper | {"timing.tau1": 0.0})) == pytest.approx(0.0008)
    assert limit_of(spec_from_parameters(paper | {"limits.clock": 0.002})) == 0.002
    none = dict.fromkeys((f"timing.tau{k}" for k in range(1, 5)), 0.0)
    assert limit_of(spec_from_parameters(paper | none)) == math.inf


def test_a_clock_that_is_wrong_for_a_test_leads_and_drifts_as_it_is_told() -> None:
    assert emulated("")(17) == 17
    assert emulated("0.003")(10**18) == 10**18 + 3_000_000
    drifting = emulated("-0.001 500e-6 1000")
    assert [drifting(s * NS) - s * NS for s in (1000, 1010)] == [-1_000_000, 4_000_000]
    with pytest.raises(InputError, match="RTHM_CLOCK is 'late', but must be"):
        emulated("late")
