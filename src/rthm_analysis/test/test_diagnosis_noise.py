"""What counts as noise of a sensor: its colour, its readings, and what is left beyond it."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import chdtri

from rthm_analysis.diagnosis.criteria.noise import FEWEST_NORMAL_AVERAGES, SLOW_POWER_CHANCE, SLOW_POWER_STDS
from rthm_analysis.diagnosis.fitting.colour import Colour, _parts, colour_of, white, whitened_from
from rthm_analysis.diagnosis.fitting.cores import Cores
from rthm_analysis.diagnosis.fitting.noise import Noise, white_noise
from rthm_analysis.diagnosis.physical import colours
from rthm_analysis.diagnosis.physical.remainder import remainder_of, slow_power
from rthm_analysis.diagnosis.replay.evidence import Channel, Evidence
from rthm_analysis.diagnosis.replay.readings import noise_level
from rthm_analysis.diagnosis.replay.resting import rests
from rthm_analysis.diagnosis.replay.updates import readings_only

from .faulty import hybrid
from .plain import recorded

COUNT = 6000
TIME = np.arange(COUNT) * 0.005
MOTION = 100.0 * np.sin(2.5 * TIME)


def wandering(rng: np.random.Generator, memory: float, share: float) -> np.ndarray:
    """White noise of power 1, and one of standard deviation `share` that forgets in `memory` samples."""
    pole, rows = np.exp(-1.0 / memory), np.empty(COUNT)
    state = share * rng.normal()
    for i, drive in enumerate(share * np.sqrt(1.0 - pole**2) * rng.normal(size=COUNT)):
        state = pole * state + drive
        rows[i] = state
    return rng.normal(size=COUNT) + rows


def test_white_noise_has_no_colour_whatever_is_left_of_the_motion() -> None:
    rng = np.random.default_rng(0)
    for left in (0.0, 1.0, 30.0):
        noise = rng.normal(size=COUNT) + left * np.sin(2.5 * TIME + 1.0)
        assert colour_of(noise, noise + MOTION, 1.0).is_white


@pytest.mark.parametrize("memory", [5.0, 20.0, 60.0])
def test_a_colour_is_found_and_taken_out(memory: float) -> None:
    noise = wandering(np.random.default_rng(1), memory, 3.0)
    colour = colour_of(noise, noise + MOTION, 1.0)
    assert abs(colour.level - np.hypot(1.0, 3.0)) < 1.0
    white = whitened_from(noise[:, None] / colour.innovation, [colour], np.array([0]))[:, 0]
    assert abs(white.std() - 1.0) < 0.05
    assert slow_power(white)[0] < 2.0 < 20.0 < slow_power(noise)[0]


def test_a_colour_in_the_band_of_the_motion_is_found_where_no_motion_can_be_left() -> None:
    noise = wandering(np.random.default_rng(4), 250.0, 1.0)
    motion = 1e4 * np.random.default_rng(5).normal(size=COUNT)
    assert colour_of(noise, noise + motion, 1.0).is_white
    assert not colour_of(noise, noise + motion, 1.0, moves=False).is_white


def test_a_colour_is_noise_where_it_is_small_beside_the_motion_or_no_louder_than_the_white_part() -> None:
    noise = wandering(np.random.default_rng(6), 20.0, 1.0)
    loud = wandering(np.random.default_rng(6), 20.0, 3.0)
    assert not colour_of(noise, noise + 0.05 * MOTION, 1.0).is_white
    assert not colour_of(loud, loud + MOTION, 1.0).is_white
    assert colour_of(loud, loud + 0.05 * MOTION, 1.0).is_white


def test_a_sensor_that_drifts_has_no_colour() -> None:
    noise = np.random.default_rng(6).normal(size=COUNT) + np.linspace(0.0, 8.0, COUNT)
    assert colour_of(noise, noise + MOTION, 1.0).is_white


@pytest.mark.parametrize("memory", [20.0, 400.0])
def test_what_two_sensors_show_is_no_noise_of_one(memory: float) -> None:
    start, colour = np.array([0]), Colour(float(np.exp(-1.0 / memory)), 0.8, 1.0, 3.0)
    for seed in range(5):
        rng = np.random.default_rng(seed)
        alone = np.stack([wandering(rng, memory, 3.0) for _ in range(3)], axis=1)
        assert colours.in_common(alone, [colour] * 3, start) == [False] * 3
        shared = alone.copy()
        shared[:, 1] = rng.normal(size=COUNT) - 0.3 * alone[:, 0]
        assert colours.in_common(shared, [colour, white(1.0), colour], start) == [True, False, False]


def test_a_model_whose_error_two_sensors_show_says_nothing_of_the_noise_that_another_model_leaves() -> None:
    before = white_noise(np.array([1.0, 1.0]))
    alone = Noise((Colour(0.8, 0.5, 1.2, 1.5), Colour(0.8, 0.5, 1.2, 1.5)))
    with_motion = Noise(tuple(replace(one, level=1.6, shared=True) for one in alone.colours))
    assert with_motion.smaller(alone).not_shared(before) == alone
    assert with_motion.not_shared(before) == before


def test_noise_of_a_force_does_not_foretell_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    force, noise = 10.0 * np.sin(0.2 * TIME), np.random.default_rng(3).normal(size=COUNT)
    evidence = Evidence.__new__(Evidence)
    vars(evidence).update(
        channels=(Channel("force", "a1"),),
        measured=(force + noise)[:, None],
        load=np.empty((COUNT, 0)),
        driven_by="force",
    )
    monkeypatch.setattr(colours, "left_by", lambda fitting, fitted: noise[:, None])
    runs = SimpleNamespace(start=np.array([0]))
    fitting = SimpleNamespace(cores=Cores(), experiment=SimpleNamespace(evidence=evidence), windows=runs)
    found = colours.coloured(fitting, None, white_noise(np.ones(1)))  # type: ignore[arg-type]
    assert found.is_white and found.level[0] == 1.0


def test_noise_whose_tails_are_heavy_throughout_is_as_large_as_its_standard_deviation() -> None:
    rng = np.random.default_rng(8)
    heavy = rng.standard_t(3, size=20_000) / np.sqrt(3.0)
    assert 0.9 < noise_level(heavy, heavy + 100.0) < 1.1
    normal = rng.normal(size=20_000)
    assert abs(noise_level(normal, normal + 100.0) - 1.0) < 0.03
    once = normal + 6.0 * (np.arange(20_000) % 10 == 0) * (np.arange(20_000) < 4_000)
    assert noise_level(once, once + 100.0) < 1.15
    beats = normal * (0.3 + np.abs(np.sin(np.arange(20_000) * 0.02)) ** 8)
    typical = 1.4826 * np.median(np.abs(np.diff(beats, 3))) / np.sqrt(20.0)
    assert noise_level(beats, beats + 100.0) < 1.02 * typical


def test_whitening_starts_anew_with_each_run() -> None:
    errors, colour = np.ones((6, 1)), Colour(0.9, 0.5, 1.0, 2.0)
    rows = whitened_from(errors, [colour], np.array([0, 3]))[:, 0]
    assert rows[0] == rows[3] == 1.0
    assert np.array_equal(rows[:3], rows[3:])


def test_what_shows_in_one_part_of_a_recording_is_seen_there() -> None:
    errors = np.random.default_rng(2).normal(size=COUNT)
    assert not remainder_of(errors, 4000).parts.size
    errors[4400:4700] += 1.0
    left = remainder_of(errors, 4000)
    assert not left.in_train and left.in_held_out
    assert left.parts.min() >= 4400 - COUNT / 30 and left.parts.max() <= 4700 + COUNT / 30


def test_what_an_imperfect_colour_leaves_throughout_is_no_event() -> None:
    errors = np.random.default_rng(7).normal(size=COUNT) + np.repeat(
        0.3 * np.random.default_rng(8).normal(size=COUNT // 20), 20
    )
    errors[:200] += 0.45
    left = remainder_of(errors, 4000, white=False)
    assert not left.in_train and not left.parts.size
    errors[:200] += 1.5
    assert remainder_of(errors, 4000, white=False).parts.size


def test_noise_that_grows_is_no_remainder() -> None:
    errors = np.random.default_rng(3).normal(size=COUNT) * np.linspace(1.0, 3.0, COUNT)
    left = remainder_of(errors, 4000)
    assert not left.in_held_out and not left.parts.size
    assert 2.0 < left.loudness < 3.0


def slower(values: np.ndarray, how: str) -> np.ndarray:
    if how == "repeated":
        return np.repeat(values[::5], 5, axis=0)[: len(values)]
    at = np.arange(len(values))
    return np.stack([np.interp(at, at[::5], column[::5]) for column in values.T], axis=1)


@pytest.mark.parametrize("how", ["repeated", "interpolated"])
def test_samples_that_are_no_readings_count_as_not_measured(how: str) -> None:
    evidence = recorded(duration=10.0)
    found = readings_only(replace(evidence, measured=slower(evidence.measured, how)))
    assert 0.15 < np.isfinite(found.measured).mean() < 0.45
    assert len(found.notes) == 2 and how in found.notes[0]


def test_what_jumps_with_held_commands_was_not_interpolated() -> None:
    exact = hybrid(noise=0.0)
    assert readings_only(exact) is exact


def test_a_coarse_sensor_and_a_rig_at_rest_have_readings_only() -> None:
    evidence = recorded(duration=10.0)
    coarse = replace(evidence, measured=np.round(evidence.measured / 2e-3) * 2e-3)
    resting = evidence.measured.copy()
    resting[1000:] = resting[1000]
    for one in (evidence, coarse, replace(evidence, measured=resting)):
        assert readings_only(one) is one


def test_a_spectrum_that_no_colour_has_is_white_and_ends_no_program() -> None:
    """The model left most in slow bands in which the rig was thought to be still; weights went to 1e300."""
    lines = np.array([0.5] * 6 + [1.0] * 3 + [1.5] + np.geomspace(2.0, 439.0, 27).tolist())
    at = np.geomspace(6.8e-4, 2.84, 37)
    left = [5.5e3, 3.3e2, 1.3e2, 9.1, 27.0, 1.6e3, 6.2e5, 7.2e5, 4.8e6, 1.1e5, 350.0, 110.0, 27.0, 65.0]
    power = np.array(left + [100.0] * 23)
    moving = np.zeros(37, dtype=bool)
    moving[3:8] = True

    assert _parts(at, power, lines, moving) is None


def test_the_quantile_of_a_few_averages_decides_below_few_alone() -> None:
    few = np.arange(1, 10 * FEWEST_NORMAL_AVERAGES)
    beyond = chdtri(few, SLOW_POWER_CHANCE) / few - 1.0 > SLOW_POWER_STDS * np.sqrt(2.0 / few)
    assert np.array_equal(beyond, few < FEWEST_NORMAL_AVERAGES)


@pytest.mark.parametrize(("left", "resting"), [(0.0, True), (3e-4, False)])
def test_a_motion_that_is_above_the_noise_does_not_rest(left: float, resting: bool) -> None:
    t = np.arange(0.0, 30.0, 0.01)
    motion = np.where(t < 15.0, np.exp(-t / 3.0), left) * np.cos(3.0 * t)
    assert rests(motion + 1e-4 * np.random.default_rng(0).standard_normal(t.size), 2000) is resting
    assert rests(1e-3 * np.round(motion / 1e-3), 2000)  # of a coarse sensor nothing is seen of it
