"""Margins of a loop that is cut at the command of a motor: closed forms, and the edge of stability itself."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rthm_analysis.lifted.linear_part import linear_part
from rthm_analysis.lifted.matrices import linear_loop
from rthm_analysis.response import response
from rthm_analysis.response.models import once_round, paths
from rthm_analysis.stability import spectral_radius, stability
from rthm_core.spec import apply, shipped_spec

PAPER = shipped_spec("paper")
ONE = np.array([1.0])
ALONE = {"interface.stiffness": [0.0], "interface.damping": [0.0], "plant.damping": [4.0]}
"""No force from the numerical side: a motor that follows the plant over its wire."""


def margins(spec):
    return response(spec, ONE).margins


def by_hand(spec):
    """Margins of L = k_tot exp(-s T) / (M s^2 + c s + k1 + k_tot), T all delay from plant to motor.

    At rest L = k_tot / (k1 + k_tot). |L| = 1 where (k1 + k_tot - M w^2)^2 + (c w)^2 = k_tot^2, which is
    quadratic in w^2; there arg L = -w T - atan2(c w, k1 + k_tot - M w^2).
    """
    mass, c, k1, k_tot = spec.plant.mass[0], spec.plant.damping[0], spec.plant.stiffness[0], spec.k_tot[0]
    t = spec.timing
    late = t.tau1 + t.tau4 + 0.5 * (t.td1 + t.td3)
    whole = k1 + k_tot
    squares = np.roots([mass**2, c**2 - 2.0 * mass * whole, whole**2 - k_tot**2])
    omega = np.sqrt(squares[np.isreal(squares) & (squares > 0.0)].real)
    phase = -omega * late - np.arctan2(c * omega, whole - mass * omega**2)
    turned = (phase + np.pi) % (2.0 * np.pi) - np.pi
    nearest = int(np.argmin(np.abs(turned)))
    delays = (phase % (2.0 * np.pi)) / omega
    return whole / k_tot, (turned[nearest], omega[nearest]), (delays.min(), omega[delays.argmin()])


def test_margins_are_those_that_are_computed_by_hand():
    spec = apply(PAPER, ALONE)
    gain, phase, delay = by_hand(spec)
    (found,) = margins(spec)
    assert found.actuator == "a1"
    assert found.gain.value == pytest.approx(gain, rel=1e-6) and found.gain.omega == 0.0
    assert found.phase == pytest.approx(phase, rel=1e-9)
    assert found.delay == pytest.approx(delay, rel=1e-9)
    assert found.gain_below is None


def test_the_loop_transfer_of_a_motor_that_follows_the_plant_is_its_closed_form():
    spec = apply(PAPER, ALONE)
    omega = np.array([0.5, 3.0, 20.0])
    late = 0.004 + 0.010 + 0.5 * (0.0012 + 0.004)
    expected = 40.0 * np.exp(-1j * omega * late) / (52.0 - 1.2 * omega**2 + 4.0j * omega)
    np.testing.assert_allclose(response(spec, omega).loop_transfer[:, 0], expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("changes", "within"),
    [({}, 2e-3), ({"actuator.motor_poles": [400.0, 2000.0]}, 2e-3), ({"plant.damping": [0.9]}, 2e-3)],
)
def test_the_delay_margin_leads_to_the_critical_tau4_of_the_exact_loop(changes, within):
    spec = apply(PAPER, changes)
    critical = stability(spec).limits["tau4"].critical_value
    (found,) = margins(spec)
    assert spec.timing.tau4 + found.delay.value == pytest.approx(critical, rel=within)


def test_beyond_the_delay_margin_the_loop_is_unstable_and_has_no_margins():
    (found,) = margins(PAPER)
    for factor, stable in ((0.99, True), (1.01, False)):
        spec = apply(PAPER, {"timing.tau4": PAPER.timing.tau4 + factor * found.delay.value})
        assert (spectral_radius(spec) < 1.0) is stable
        (there,) = margins(spec)
        assert (there.delay is not None) is stable
    assert (there.gain, there.gain_below, there.phase) == (None, None, None)


@pytest.mark.parametrize("motor", [0, 1])
@pytest.mark.parametrize("which", ["gain", "phase", "delay"])
def test_with_several_motors_a_margin_on_the_command_of_one_brings_the_whole_loop_to_its_edge(motor, which):
    spec, _ = linear_part(shipped_spec("three_mass"))
    found = getattr(margins(spec)[motor], which)
    factor = {
        "gain": found.value,
        "phase": np.exp(-1j * found.value),
        "delay": np.exp(-1j * found.omega * found.value),
    }[which]
    command = np.eye(2, dtype=complex)
    command[motor, motor] = factor
    round_once = once_round(linear_loop(spec), paths(spec, holds=True), 1j * max(found.omega, 1e-9))
    assert np.abs(np.linalg.det(np.eye(2) - command @ round_once)) < 1e-7
    assert np.abs(np.linalg.det(np.eye(2) - round_once)) > 1e-3


def test_json_has_every_margin_with_its_frequency_and_null_where_there_is_none():
    (told,) = response(PAPER, ONE).as_dict()["margins"]
    assert set(told) == {"actuator", "gain", "gain_below", "phase_deg", "delay"}
    assert told["gain_below"] is None
    assert told["phase_deg"]["value"] == pytest.approx(math.degrees(margins(PAPER)[0].phase.value))
    assert all(set(told[name]) == {"value", "omega"} for name in ("gain", "phase_deg", "delay"))
