"""Faults of recordings: each is found and mended, and nothing is found where nothing is wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rthm_analysis.diagnosis.faults import mend
from rthm_analysis.diagnosis.faults.hum import find_hum
from rthm_analysis.diagnosis.faults.naming import BLOCKS
from rthm_analysis.diagnosis.faults.unit_ratios import known_factor
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_core.spec import Spec, apply

from .faulty import (
    CHANNELS,
    FORCE,
    MOTOR,
    NOISE,
    PAPER,
    PLAIN,
    POSITION,
    TD1,
    VELOCITY,
    changed,
    having,
    hybrid,
    later,
    plain,
)

FIELDS = ("x1.position", "x1.velocity", "a1.effort", "a1.position")
FREE = apply(PLAIN, {"plant.initial_position": [0.5]})


@pytest.fixture(scope="module", params=[0, 1])
def loop(request: pytest.FixtureRequest) -> Evidence:
    return hybrid(seed=request.param)


@pytest.fixture(scope="module")
def driven() -> Evidence:
    return plain(seed=3)


@pytest.fixture(scope="module")
def free() -> Evidence:
    return plain(FREE, seed=4, driven=False)


def said(evidence: Evidence, spec: Spec) -> list[tuple[str, str]]:
    return [(fault.kind, fault.channel) for fault in mend(evidence, spec).faults]


def far(one: Evidence, other: Evidence, column: int) -> float:
    """Largest difference of a channel where both know it."""
    return float(np.nanmax(np.abs(one.measured[:, column] - other.measured[:, column])))


@pytest.mark.parametrize("column", range(4))
@pytest.mark.parametrize("factor", [-1.0, 1000.0, -1000.0])
def test_another_sign_or_unit_is_found_and_turned_back(loop: Evidence, column: int, factor: float) -> None:
    mended = mend(changed(loop, column, lambda y: factor * y), PAPER)
    (fault,) = mended.faults
    assert (fault.kind, fault.channel) == ("sign" if factor == -1.0 else "unit", FIELDS[column])
    assert fault.value == pytest.approx(factor) and fault.interval is None
    assert far(mended.evidence, loop, column) < 1e-9


def test_a_whole_axis_that_points_the_other_way_is_two_signs(loop: Evidence) -> None:
    turned = changed(changed(loop, POSITION, np.negative), VELOCITY, np.negative)
    assert said(turned, PAPER) == [("sign", "x1.position"), ("sign", "x1.velocity")]


def test_degrees_and_pounds_are_known(loop: Evidence) -> None:
    assert said(changed(loop, VELOCITY, np.rad2deg), PAPER) == [("unit", "x1.velocity")]
    (fault,) = mend(changed(loop, FORCE, lambda y: y / 4.4482), PAPER).faults
    assert "lbf" in fault.words and "--unit force:a1=4.448" in fault.words


@pytest.mark.parametrize("pair", [(POSITION, VELOCITY), (POSITION, MOTOR), (FORCE, MOTOR), (POSITION, FORCE)])
def test_swapped_channels_are_put_back(loop: Evidence, pair: tuple[int, int]) -> None:
    measured = loop.measured.copy()
    measured[:, list(pair)] = measured[:, list(pair[::-1])]
    mended = mend(replace(loop, measured=measured), PAPER)
    assert [fault.kind for fault in mended.faults] == ["swapped"]
    assert np.array_equal(mended.evidence.measured, loop.measured)


@pytest.mark.parametrize("column", range(4))
def test_spikes_are_left_out_one_by_one(loop: Evidence, column: int) -> None:
    rng = np.random.default_rng(column)
    at = np.arange(500, 9500, 450)
    size = 0.3 * np.ptp(loop.measured[:, column]) * rng.choice([-1.0, 1.0], at.size)
    mended = mend(changed(loop, column, lambda y: _plus(y, at, size)), PAPER)
    (fault,) = mended.faults
    assert (fault.kind, fault.channel, fault.value) == ("spikes", FIELDS[column], at.size)
    assert np.array_equal(np.flatnonzero(np.isnan(mended.evidence.measured[:, column])), at)
    assert fault.interval == pytest.approx((at[0] * TD1 * 1e-9, at[-1] * TD1 * 1e-9))


def _plus(values: np.ndarray, at: np.ndarray, size: np.ndarray) -> np.ndarray:
    values[at] += size
    return values


@pytest.mark.parametrize("column", range(4))
def test_a_stuck_sensor_is_found_with_its_time(loop: Evidence, column: int) -> None:
    mended = mend(changed(loop, column, lambda y: _held(y, 4000, 4300)), PAPER)
    (fault,) = mended.faults
    assert (fault.kind, fault.channel) == ("stuck", FIELDS[column])
    assert fault.interval == pytest.approx((4000 * TD1 * 1e-9, 4299 * TD1 * 1e-9), abs=3e-3)
    assert np.isnan(mended.evidence.measured[4000:4300, column]).all()


def _held(values: np.ndarray, first: int, last: int, held: float | None = None) -> np.ndarray:
    values[first:last] = values[first] if held is None else held
    return values


@pytest.mark.parametrize("column", [POSITION, VELOCITY, FORCE])
def test_a_sensor_whose_range_ends_is_told_with_the_end(loop: Evidence, column: int) -> None:
    limit = 0.7 * float(np.abs(loop.measured[:, column]).max())
    mended = mend(changed(loop, column, lambda y: np.clip(y, -limit, limit)), PAPER)
    (fault,) = mended.faults
    assert (fault.kind, fault.channel, abs(fault.value)) == ("saturation", FIELDS[column], limit)
    left_out = np.isnan(mended.evidence.measured[:, column])
    beyond = np.abs(loop.measured[:, column]) >= limit
    assert left_out[beyond].all() and left_out.mean() < beyond.mean() + 0.03


@pytest.mark.parametrize("column", [POSITION, VELOCITY])
def test_a_magnitude_gets_its_signs_back(driven: Evidence, column: int) -> None:
    mended = mend(changed(driven, column, np.abs), PLAIN)
    assert [(one.kind, one.channel) for one in mended.faults] == [("rectified", FIELDS[column])]
    assert far(mended.evidence, driven, column) == 0.0
    assert np.mean(np.isnan(mended.evidence.measured[:, column])) < 0.1


def test_a_magnitude_alone_is_told_by_the_known_force(driven: Evidence) -> None:
    alone = replace(driven, channels=driven.channels[:1], measured=np.abs(driven.measured[:, :1]))
    mended = mend(alone, PLAIN)
    assert [(one.kind, one.channel) for one in mended.faults] == [("rectified", "x1.position")]
    assert far(mended.evidence, driven, POSITION) == 0.0


def test_a_force_without_its_sign_is_told_by_its_wire(loop: Evidence) -> None:
    mended = mend(changed(loop, FORCE, np.abs), PAPER)
    assert [(one.kind, one.channel) for one in mended.faults] == [("rectified", "a1.effort")]
    assert far(mended.evidence, loop, FORCE) == 0.0


def test_a_motion_that_bounces_at_zero_is_no_magnitude() -> None:
    spec = having(FREE, "plant", "end_stop", position=1e-9, stiffness=3e5, damping=0.0)
    bounced = plain(apply(spec, {"plant.initial_position": [-0.5]}), driven=False)
    down = changed(bounced, POSITION, lambda x: np.minimum(x, 0.0))
    assert said(down, apply(FREE, {"plant.initial_position": [-0.5]})) == []


def test_one_spike_in_noise_of_heavy_tails_is_noise(loop: Evidence) -> None:
    rng = np.random.default_rng(5)
    heavy = [
        changed(loop, POSITION, lambda y: y + NOISE[POSITION] * rng.standard_t(2.5, y.size)) for _ in range(5)
    ]
    assert [said(one, PAPER) for one in heavy] == [[]] * 5


@pytest.mark.parametrize("held", [np.nan, 0.0, None])
def test_drop_outs_are_told_however_they_are_recorded(loop: Evidence, held: float | None) -> None:
    def cut(values: np.ndarray) -> np.ndarray:
        for first in (2000, 3300, 5100, 8000):
            _held(values, first, first + 40, held)
        return values

    mended = mend(changed(loop, POSITION, cut), PAPER)
    assert [(one.kind, one.channel) for one in mended.faults] == [("dropout", "x1.position")]
    lost = np.count_nonzero(np.isnan(mended.evidence.measured[:, POSITION]))
    assert 120 <= lost <= 164  # where the rig stands still, a value that is held is as good as any


@pytest.mark.parametrize("delay", [0.012, -0.012, 0.036])
@pytest.mark.parametrize("column", [POSITION, VELOCITY, FORCE])
def test_a_late_channel_is_told_from_the_others(loop: Evidence, column: int, delay: float) -> None:
    (fault,) = mend(later(loop, column, delay), PAPER).faults
    assert (fault.kind, fault.channel) == ("channel_delay", FIELDS[column])
    assert fault.value == pytest.approx(delay, abs=4e-4)


@pytest.mark.parametrize("block", ["sensor.position", "sensor.velocity", "sensor.force"])
def test_a_lag_is_no_delay(block: str) -> None:
    assert said(hybrid(having(PAPER, block, "lag", time_constant=0.02)), PAPER) == []


@pytest.mark.parametrize(("column", "size", "mains"), [(0, 3e-4, 50.0), (1, 0.01, 60.0), (2, 0.1, 50.0)])
def test_hum_is_measured_and_taken_out(loop: Evidence, column: int, size: float, mains: float) -> None:
    wave = size * np.sin(2.0 * np.pi * (mains + 0.03) * loop.time + 0.7)
    mended = mend(changed(loop, column, lambda y: y + wave), PAPER)
    (fault,) = mended.faults
    assert (fault.kind, fault.channel) == ("hum", FIELDS[column])
    assert fault.value == pytest.approx(size, rel=0.1)
    left = mended.evidence.measured[:, column] - loop.measured[:, column]
    assert left.std() < 0.15 * wave.std()


@pytest.mark.parametrize("way", ["repeated", "interpolated"])
def test_a_slow_sensor_has_no_hum_where_its_readings_come_at_the_rate_of_the_mains(way: str) -> None:
    count, step = 12_000, 14_947_751
    time = 1e-9 * step * np.arange(count)
    noise = 1e-4 * np.random.default_rng(1).normal(size=count)
    x = np.sin(2.0 * np.pi * 0.11 * time) + noise
    held = np.repeat(x[::4], 4) if way == "repeated" else np.interp(time, time[::4], x[::4])
    stamps = step * np.arange(count, dtype=np.int64)
    channels = (Channel("position", "x1"),)
    seen = Evidence(
        stamps, stamps[:0], np.zeros((0, 0)), np.zeros((count, 1)), channels, held[:, None], "force"
    )
    spec = apply(PLAIN, {"plant.mass": [1.0], "plant.damping": [0.0], "plant.stiffness": [0.5]})
    assert find_hum(seen, spec)[1] == []
    wave = 0.01 * np.sin(2.0 * np.pi * 50.02 * time)
    (fault,) = find_hum(replace(seen, measured=(x + wave)[:, None]), spec)[1]
    assert fault.kind == "hum"


@pytest.mark.parametrize("drift", [4e-4, -6e-4])
def test_stamps_that_drift_are_set_right(loop: Evidence, drift: float) -> None:
    stamps = np.round(loop.stamps_ns * (1.0 + drift)).astype(np.int64)
    mended = mend(replace(loop, stamps_ns=stamps), PAPER)
    (fault,) = mended.faults
    assert fault.kind == "clock_drift" and fault.value == pytest.approx(drift, rel=0.1)
    assert np.abs(mended.evidence.stamps_ns - loop.stamps_ns).max() < TD1


@pytest.mark.parametrize(
    ("changes", "entry"),
    [
        ({"plant.initial_position": [0.9]}, "plant.initial_position"),
        ({"actuator.stiffness": [250.0]}, "actuator.stiffness"),
        ({"plant.mass": [8.0]}, "plant.mass"),
        ({"timing.td1": 0.0015}, "timing.td1"),
    ],
)
def test_the_spec_of_another_test_is_told(loop: Evidence, changes: dict[str, object], entry: str) -> None:
    assert said(loop, apply(PAPER, changes)) == [("wrong_spec", entry)]


def test_a_stiffness_that_is_said_to_be_unknown_is_no_other_test(loop: Evidence) -> None:
    spec = apply(PAPER, {"actuator.stiffness": [10.0], "uncertainty.actuator.stiffness": 1.0})
    assert said(loop, spec) == []


@pytest.mark.parametrize("factor", [-1.0, 1000.0, 0.001])
def test_a_known_force_is_checked_by_the_motion(driven: Evidence, factor: float) -> None:
    mended = mend(replace(driven, load=factor * driven.load), PLAIN)
    (fault,) = mended.faults
    assert (fault.block, fault.kind) == ("sensor.force", "sign" if factor < 0.0 else "unit")
    assert fault.value == pytest.approx(factor) and np.allclose(mended.evidence.load, driven.load)


@pytest.mark.parametrize("factor", [-1.0, 100.0, 1000.0])
def test_a_position_that_rate_and_force_speak_against_is_the_one_that_is_wrong(
    driven: Evidence, factor: float
) -> None:
    mended = mend(changed(driven, POSITION, lambda y: factor * y), PLAIN)
    assert [(one.channel, one.value) for one in mended.faults] == [("x1.position", pytest.approx(factor))]
    assert far(mended.evidence, driven, POSITION) < 1e-9 and far(mended.evidence, driven, VELOCITY) < 1e-9
    assert np.allclose(mended.evidence.load, driven.load)


@pytest.mark.parametrize("factor", [1000.0, 57.29578, 39.37008])
def test_a_free_motion_in_another_unit_shows_at_its_start(free: Evidence, factor: float) -> None:
    wrong = replace(free, measured=factor * free.measured)
    assert said(wrong, FREE) == [("unit", "x1.position"), ("unit", "x1.velocity")]
    assert said(changed(free, VELOCITY, np.negative), FREE) == [("sign", "x1.velocity")]


def test_a_free_motion_that_begins_elsewhere_is_in_no_other_unit(free: Evidence) -> None:
    assert said(replace(free, measured=3.2 * free.measured), FREE) == []  # feet: 3.281


def test_a_free_motion_of_another_plant_is_told(free: Evidence) -> None:
    assert said(free, apply(FREE, {"plant.stiffness": [1.0]})) == []  # 3.5 times as fast: a stop can do that
    assert said(free, apply(FREE, {"plant.stiffness": [0.1]})) == [("wrong_spec", "plant.stiffness")]
    assert said(free, apply(FREE, {"plant.stiffness": [200.0]})) == [("wrong_spec", "plant.stiffness")]


def test_a_gain_is_a_unit_only_if_it_is_one() -> None:
    assert [known_factor(gain, "force") for gain in (1.3, -0.7, 7.0, 4.5)] == [
        1.0,
        -1.0,
        None,
        pytest.approx(4.448222),
    ]
    assert known_factor(9.9, "load", 0.2) is None  # of an uncertain gain only decades are believed


CLEAN = [
    ("plant", "coulomb_friction", {"force": 3.0}),
    ("plant", "end_stop", {"position": 0.5, "stiffness": 20_000.0, "damping": 5.0}),
    ("plant", "clearance", {"gap": 0.1, "stiffness": 240.0}),
    ("plant", "hidden_mode", {"mass": 0.5, "frequency": 6.0, "damping_ratio": 0.02}),
    ("plant", "maxwell_branch", {"stiffness": 60.0, "damping": 5.0}),
    ("plant", "constant_load", {"force": 2.0}),
    ("wire", "backlash", {"gap": 0.03}),
    ("wire", "slack", {"pretension": 0.5}),
    ("wire", "hardening", {"coefficient": 5000.0}),
    ("wire", "pulley_inertia", {"mass": 0.05, "damping": 0.2}),
    ("wire", "bouc_wen", {"alpha": 30.0, "A": 1.0, "beta": 50.0, "gamma": 20.0, "n": 1.0}),
    ("motor", "saturation", {"limit": 0.55}),
    ("motor", "rate_limit", {"rate": 0.3}),
    ("motor", "second_order", {"frequency": 40.0, "damping_ratio": 0.3}),
    ("motor", "quantisation", {"step": 0.005}),
    ("sensor.position", "scale", {"scale": 1.2}),
    ("sensor.velocity", "quantisation", {"step": 0.05}),
    ("sensor.force", "drift", {"rate": 0.05}),
]


@pytest.mark.parametrize("noise", [0.0, 1.0])
@pytest.mark.parametrize(("block", "kind", "parameters"), CLEAN)
def test_no_effect_of_the_rig_is_a_fault(
    block: str, kind: str, parameters: dict[str, float], noise: float
) -> None:
    assert said(hybrid(having(PAPER, block, kind, **parameters), 5, noise, 6000), PAPER) == []


@pytest.mark.parametrize("spec", [PAPER, PLAIN, FREE])
def test_ugly_recordings_have_no_faults(spec: Spec) -> None:
    evidence = hybrid() if spec is PAPER else plain(spec, driven=spec is PLAIN)
    rng, samples = np.random.default_rng(7), evidence.measured.shape[0]
    for width in (80, 800):
        slow = rng.normal(size=(samples, evidence.measured.shape[1])).cumsum(axis=0)
        slow[width:] -= slow[:-width].copy()
        level = 3.0 * NOISE[: slow.shape[1]] / slow.std(axis=0)
        assert said(replace(evidence, measured=evidence.measured + level * slow), spec) == []
    for part in (0.001, 0.01, 0.05):
        step = part * np.ptp(evidence.measured, axis=0)
        assert said(replace(evidence, measured=np.round(evidence.measured / step) * step), spec) == []
    for many in (2, 5, 10):
        repeated = evidence.measured[np.arange(samples) // many * many]
        assert said(replace(evidence, measured=repeated), spec) == []


@pytest.mark.parametrize("value", [0.0, 0.3])
@pytest.mark.parametrize("spec", [PAPER, PLAIN, FREE])
def test_a_channel_that_never_changes_is_told_and_left_out(spec: Spec, value: float) -> None:
    evidence = hybrid() if spec is PAPER else plain(spec, driven=spec is PLAIN)
    for column, channel in enumerate(evidence.channels):
        mended = mend(changed(evidence, column, lambda y: np.full_like(y, value)), spec)
        kind = "stuck" if value else "dropout"
        assert [(one.kind, one.block) for one in mended.faults] == [(kind, BLOCKS[channel.family])]
        assert channel not in mended.evidence.channels
        assert len(mended.evidence.channels) == len(evidence.channels) - 1


def test_a_rig_that_rests_has_no_dead_channel(loop: Evidence) -> None:
    still = replace(loop, commands=np.zeros_like(loop.commands), measured=np.zeros_like(loop.measured))
    assert said(still, PAPER) == []


def test_a_position_of_wrong_sign_leaves_the_velocity_unblamed() -> None:
    evidence = plain(FREE, driven=False)
    position = [one.family for one in evidence.channels].index("position")
    assert said(changed(evidence, position, np.negative), FREE) == [("sign", "x1.position")]


def test_a_rig_at_rest_has_no_faults(loop: Evidence) -> None:
    still = replace(loop, commands=np.full_like(loop.commands, 0.5))
    scatter = np.random.default_rng(1).normal(size=loop.measured.shape) * NOISE
    for noise in (0.0 * scatter, scatter, np.round(scatter / (3.0 * NOISE)) * 3.0 * NOISE):
        assert said(replace(still, measured=np.array([0.5, 0.0, 0.0, 0.5]) + noise), PAPER) == []


def test_what_was_not_measured_is_no_fault(loop: Evidence) -> None:
    for families in (("position",), ("velocity",), ("position", "force"), ("force", "motor")):
        assert said(loop.only(*families), PAPER) == []
    assert len(loop.channels) == len(CHANNELS)
