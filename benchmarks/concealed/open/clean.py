"""Cases in which nothing is missing: ugly noise, slow and coarse sensors, other scales, rest."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from benchmarks.concealed.open import faults, noise
from benchmarks.concealed.open.draft import Draft, any_world, open_draft
from benchmarks.concealed.open.parameters import plant_values
from benchmarks.concealed.open.truth import Hidden
from benchmarks.concealed.open.worlds import between, draw_loop, draw_plain

Recipe = Callable[[np.random.Generator, float], Draft]
POSITION, VELOCITY, MOTOR, FORCE = range(4)
UNSURE = {"mass": 0.05, "damping": 0.5, "stiffness": 0.05}


def plain_noise(rng: np.random.Generator, boost: float) -> Draft:
    """White noise of the usual size."""
    return any_world(rng, boost)


def other_sizes(rng: np.random.Generator, boost: float) -> Draft:
    """White noise, each channel 0.1 to 30 times as loud as usual; the loop bears 3 times on what it uses."""
    draft = any_world(rng, boost)
    most = 30.0 if draft.setting.plain else 3.0
    factors = [between(rng, 0.1, m) for m in (most, most, 30.0, 30.0)]
    draft.noise_size = draft.noise_size * np.array(factors)
    return draft


def with_noise(make: Callable[[np.random.Generator], noise.Noise]) -> Recipe:
    """Return the recipe of noise that is not white."""

    def recipe(rng: np.random.Generator, boost: float) -> Draft:
        draft = any_world(rng, boost)
        draft.noise = make(rng)
        return draft

    return recipe


def _sensed(draft: Draft) -> list[int]:
    """Channels that a sensor can show coarsely without the loop being another."""
    if draft.setting.plain:
        return [POSITION, VELOCITY] if draft.setting.velocity else [POSITION]
    return [MOTOR, FORCE]


def quantised(rng: np.random.Generator, boost: float) -> Draft:
    """Coarse sensors: steps of 1 to 20 times the noise."""
    draft = any_world(rng, boost)
    for column in _sensed(draft):
        draft.edits.append(faults.rounded(column, between(rng, 1.0, 20.0)))
        block = ("sensor.position", "sensor.velocity", "sensor.motor", "sensor.force")[column]
        draft.tolerated.append(Hidden("coarse steps", (block,), kind="quantisation"))
    return draft


def slow_sensors(change: Callable[[int, int], faults.Edit]) -> Recipe:
    """Return the recipe of sensors that are slower than the recording."""

    def recipe(rng: np.random.Generator, boost: float) -> Draft:
        plain = rng.random() < 0.6
        setting = draw_plain(rng, per_period=between(rng, 200.0, 1500.0)) if plain else draw_loop(rng)
        draft, times = open_draft(rng, setting, boost), int(rng.integers(2, 6))
        for column in _sensed(draft):
            draft.edits.append(change(column, times))
            block = ("sensor.position", "sensor.velocity", "sensor.motor", "sensor.force")[column]
            hold = Hidden("slow sensor", (block,), faults=("channel_delay",), kind="extra_delay")
            draft.tolerated.append(hold)
        return draft

    return recipe


def at_rest(rng: np.random.Generator, boost: float) -> Draft:
    """Nothing moves in the first half of the recording."""
    plain = rng.random() < 0.6
    setting = draw_plain(rng, loaded=True) if plain else draw_loop(rng, loaded=True)
    draft = open_draft(rng, setting, boost)
    half = round(0.5 * setting.duration, 3)
    draft.true.start = half
    for spec in (draft.spec, draft.told):
        spec.pop("load", None)
        for part in ("plant", "numerical"):
            if "initial_position" in spec[part]:
                spec[part]["initial_position"] = [0.0]
    if not plain:
        draft.true.ramp1 = draft.true.ramp2 = 2.0
    return draft


def uncertain(rng: np.random.Generator, boost: float) -> Draft:
    """The plant's parameters are off by about as much as the spec says."""
    draft = any_world(rng, boost)
    for name, std in UNSURE.items():
        off = std * float(np.clip(rng.normal(), -2.0, 2.0)) * (0.8 if name == "damping" else 1.0)
        draft.told["plant"][name] = [draft.spec["plant"][name][0] / max(1.0 + off, 0.1)]
    draft.told["uncertainty"] = {"plant": dict(UNSURE)}
    names = ("plant.mass", "plant.damping", "plant.stiffness")
    draft.tolerated.append(Hidden("as told", ("plant",), retuned=names, parameters=plant_values(draft)))
    draft.allowed = ("retuned",)
    return draft


def on_rig(**words: object) -> Recipe:
    """Return the recipe of a plant alone of this kind."""

    def recipe(rng: np.random.Generator, boost: float) -> Draft:
        return open_draft(rng, draw_plain(rng, **words), boost)

    return recipe


def kilohertz(rng: np.random.Generator, boost: float) -> Draft:
    """15 000 samples over 40 periods of a rig of kilohertz."""
    return open_draft(rng, draw_plain(rng, rig="resonator", per_period=375.0, periods=40.0), boost)


def compensated(rng: np.random.Generator, boost: float) -> Draft:
    """The controller runs the compensator that the spec states."""
    draft = open_draft(rng, draw_loop(rng), boost)
    draft.spec["actuator"]["compensator"] = draft.told["actuator"]["compensator"] = "taylor"
    return draft


RECIPES: dict[str, Recipe] = {
    "plain_noise": plain_noise,
    "other_sizes": other_sizes,
    "coloured": with_noise(lambda rng: noise.coloured(between(rng, 0.01, 1.0))),
    "half_coloured": with_noise(lambda rng: noise.mixed(between(rng, 0.01, 1.0))),
    "heavy_tails": with_noise(lambda rng: noise.heavy),
    "growing_noise": with_noise(lambda rng: noise.growing),
    "quantised": quantised,
    "repeated": slow_sensors(faults.repeated),
    "interpolated": slow_sensors(faults.interpolated),
    "at_rest": at_rest,
    "uncertain": uncertain,
    "kilohertz": kilohertz,
    "ship": on_rig(rig="ship"),
    "machine": on_rig(rig="machine"),
    "sparse": on_rig(per_period=20.0),
    "dense": on_rig(per_period=2000.0),
    "few_periods": on_rig(periods=6.0),
    "compensated": compensated,
}
