"""Cases with faults of the recording or of the spec."""

from __future__ import annotations

import copy
from collections.abc import Callable

import numpy as np
from benchmarks.concealed.loop import W1
from benchmarks.concealed.open import faults
from benchmarks.concealed.open.draft import Draft, any_world, open_draft
from benchmarks.concealed.open.parameters import plant_values
from benchmarks.concealed.open.truth import Hidden
from benchmarks.concealed.open.worlds import draw_loop, draw_plain

Recipe = Callable[[np.random.Generator, float], Draft]
POSITION, VELOCITY, MOTOR, FORCE = range(4)
BLOCKS = {
    POSITION: ("sensor.position",),
    VELOCITY: ("sensor.velocity",),
    MOTOR: ("sensor.motor", "motor"),
    FORCE: ("sensor.force",),
    W1: ("sensor.load", "sensor.force", "load"),
}
WORDS = {POSITION: "position", VELOCITY: "velocity", MOTOR: "motor", FORCE: "force", W1: "load"}


def _channel(draft: Draft, *never: int) -> int:
    """Draw a recorded channel that the loop does not live on."""
    if draft.setting.plain:
        there = [POSITION] + [VELOCITY] * draft.setting.velocity + [W1] * draft.setting.loaded
    else:
        there = [VELOCITY, FORCE, MOTOR]
    return int(draft.rng.choice([c for c in there if c not in never]))


def _note(
    draft: Draft, column: int, what: str, kinds: tuple[str, ...], kind: str = "", **more: float
) -> None:
    """Note a fault of a channel; in a plant of one channel and a load, either may be at fault."""
    blocks = BLOCKS[column]
    if draft.setting.plain and draft.setting.loaded and not draft.setting.velocity and kind != "only":
        blocks = BLOCKS[POSITION] + BLOCKS[W1] if what.split()[0] in ("sign", "unit", "late") else blocks
    words = f"{what} of {WORDS[column]}"
    draft.hidden.append(Hidden(words, blocks, faults=kinds, kind=kind, parameters=more))
    draft.measure = "edit" if column < W1 else "certain"


def wrong_sign(rng: np.random.Generator, boost: float) -> Draft:
    """A channel has the other sign."""
    draft = any_world(rng, boost)
    if draft.setting.plain:  # without a load and a velocity, nothing has a sign
        draft = open_draft(rng, draw_plain(rng, loaded=True), boost)
    column = _channel(draft)
    draft.edits.append(faults.gain(column, -1.0))
    _note(draft, column, "sign", ("sign",), "scale")
    return draft


def wrong_unit(rng: np.random.Generator, boost: float) -> Draft:
    """A channel is in mm, kN, g of force, degrees, or inches."""
    draft = any_world(rng, boost)
    column = _channel(draft)
    length = (1000.0, 100.0, 57.29578, 39.37008)
    factor = float(rng.choice((1e-3, 101.9716, 0.2248) if column in (FORCE, W1) else length))
    draft.edits.append(faults.gain(column, factor))
    _note(draft, column, "unit", ("unit",), "scale", scale=factor)
    if column == W1:  # a force of another unit is a plant of another mass, damping and stiffness
        draft.hidden[-1] = _as_retuned(draft, 1.0 / factor)
    return draft


def millimetres(rng: np.random.Generator, boost: float) -> Draft:
    """A plant alone, all of its motion in mm."""
    draft = open_draft(rng, draw_plain(rng), boost)
    for column in (POSITION, VELOCITY):
        draft.edits.append(faults.gain(column, 1000.0))
    blocks = BLOCKS[POSITION] + BLOCKS[VELOCITY] + (BLOCKS[W1] if draft.setting.loaded else ())
    draft.hidden.append(Hidden("unit of all motion", blocks, faults=("unit",), kind="scale"))
    draft.measure = "edit"
    return draft


def _as_retuned(draft: Draft, factor: float) -> Hidden:
    old = draft.hidden[-1]
    names = ("plant.mass", "plant.damping", "plant.stiffness")
    values = {k: v / factor for k, v in plant_values(draft).items()}
    return Hidden(old.what, old.blocks, faults=old.faults, kind=old.kind, retuned=names, parameters=values)


def swapped_channels(rng: np.random.Generator, boost: float) -> Draft:
    """Two channels have each other's names."""
    if rng.random() < 0.5:
        draft = open_draft(rng, draw_plain(rng, velocity=True), boost)
        one, other = POSITION, VELOCITY
    else:
        draft = open_draft(rng, draw_loop(rng), boost)
        one, other = ((POSITION, MOTOR), (POSITION, VELOCITY), (VELOCITY, FORCE))[rng.integers(3)]
    draft.edits.append(faults.swapped(one, other))
    draft.hidden.append(Hidden("swapped channels", BLOCKS[one] + BLOCKS[other], faults=("swapped",)))
    draft.measure = "edit"
    return draft


def late_channel(rng: np.random.Generator, boost: float) -> Draft:
    """A channel is late, or early, by some samples."""
    draft = any_world(rng, boost)
    if draft.setting.plain and not (draft.setting.loaded or draft.setting.velocity):
        draft = open_draft(rng, draw_plain(rng, loaded=True), boost)
    column = _channel(draft)
    if draft.setting.plain:
        per_period = len(draft.setting.pilot) / max(_periods(draft), 1.0)
        samples = max(int(per_period * rng.uniform(0.01, 0.06) * boost), 1)
    else:
        samples = int(rng.integers(2, 12) * boost)
    samples *= int(rng.choice([-1, 1]))
    draft.edits.append(faults.late(column, samples))
    _note(draft, column, "late samples", ("channel_delay",), "extra_delay")
    return draft


def _periods(draft: Draft) -> float:
    return draft.setting.duration * draft.scene.w / (2.0 * np.pi)


def spiked(rng: np.random.Generator, boost: float) -> Draft:
    """Single samples are far off."""
    draft = any_world(rng, boost)
    column = _channel(draft, W1)
    draft.edits.append(faults.spikes(column, int(rng.integers(3, 60)), rng.uniform(1.0, 10.0)))
    _note(draft, column, "spikes", ("spikes",))
    return draft


def stuck_sensor(rng: np.random.Generator, boost: float) -> Draft:
    """A sensor holds its last value for some stretches."""
    draft = any_world(rng, boost)
    column = _channel(draft, W1)
    share = rng.uniform(0.02, 0.15)
    draft.edits.append(faults.stretches(column, int(rng.integers(1, 6)), share, "last"))
    _note(draft, column, "stuck stretches", ("stuck", "dropout"))
    return draft


def dropped_out(rng: np.random.Generator, boost: float) -> Draft:
    """A sensor shows zero, or no number, for some stretches."""
    draft = any_world(rng, boost)
    column, fill = _channel(draft, W1), str(rng.choice(["zero", "nan"]))
    count, share = int(rng.integers(1, 12)), rng.uniform(0.01, 0.1)
    draft.edits.append(faults.stretches(column, count, share, fill))
    _note(draft, column, f"drop-outs ({fill})", ("dropout", "stuck"))
    draft.allowed = ("match",) if fill == "nan" else ()
    return draft


def hum(rng: np.random.Generator, boost: float) -> Draft:
    """The mains are heard on a channel."""
    if rng.random() < 0.5:
        setting = draw_plain(rng, rig="bench", per_period=rng.uniform(250.0, 1000.0))
    else:
        setting = draw_loop(rng, rig="paper")
    draft = open_draft(rng, setting, boost)
    column = _channel(draft, W1)
    draft.edits.append(faults.hum(column, min(rng.uniform(0.01, 0.1) * boost, 0.5)))
    _note(draft, column, "hum", ("hum",))
    return draft


def clipped_sensor(rng: np.random.Generator, boost: float) -> Draft:
    """A sensor ends before the motion does."""
    draft = any_world(rng, boost)
    column = _channel(draft, W1)
    draft.edits.append(faults.clipped(column, min(rng.uniform(0.03, 0.15) * boost, 0.5)))
    _note(draft, column, "clipping", ("saturation", "clipped", "stuck"), "saturation")
    return draft


def rectified_sensor(rng: np.random.Generator, boost: float) -> Draft:
    """A sensor knows no sign."""
    draft = any_world(rng, boost)
    column = _channel(draft, W1)
    draft.edits.append(faults.rectified(column))
    _note(draft, column, "lost sign", ("rectified",), "rectified")
    return draft


def dead_channel(rng: np.random.Generator, boost: float) -> Draft:
    """The velocity is recorded as zero throughout."""
    draft = open_draft(rng, draw_plain(rng, velocity=True), boost)
    draft.edits.append(faults.constant(VELOCITY, 0.0))
    _note(draft, VELOCITY, "dead channel", ("stuck", "dropout"))
    draft.allowed = ("match",)
    return draft


def other_delay(link: int) -> Recipe:
    """Return the recipe of a spec with another tau, longer or shorter than the true one."""

    def recipe(rng: np.random.Generator, boost: float) -> Draft:
        draft = open_draft(rng, draw_loop(rng), boost)
        true = draft.spec["timing"][f"tau{link}"]
        sign = rng.choice([-1.0, 1.0])
        off = min(rng.uniform(0.1, 0.4) * true * boost, 0.8 * true if sign < 0 else 0.01)
        draft.told["timing"][f"tau{link}"] = round(true + sign * off, 6)
        real = (true - draft.told["timing"][f"tau{link}"]) * draft.setting.scale.time
        blocks = ("motor", "link.tau4") if link == 4 else (f"link.tau{link}",)
        draft.hidden.append(
            Hidden(
                f"other tau{link}",
                blocks,
                faults=("wrong_parameter",),
                kind="extra_delay",
                parameters={"delay": real},
            )
        )
        draft.measure = "links"
        return draft

    return recipe


def compensator_not_run(rng: np.random.Generator, boost: float) -> Draft:
    """The spec says `taylor`, the controller has no compensator."""
    draft = open_draft(rng, draw_loop(rng), boost)
    draft.told["actuator"]["compensator"] = "taylor"
    draft.hidden.append(
        Hidden("told compensator not run", ("controller",), ("parameter",), faults=("wrong_parameter",))
    )
    return draft


def compensator_not_told(rng: np.random.Generator, boost: float) -> Draft:
    """The controller runs `taylor`, of which the spec does not know."""
    draft = open_draft(rng, draw_loop(rng), boost)
    draft.spec["actuator"]["compensator"] = "taylor"
    draft.hidden.append(
        Hidden("compensator not told", ("controller",), ("parameter",), faults=("wrong_parameter",))
    )
    return draft


def other_spec(rng: np.random.Generator, boost: float) -> Draft:
    """The spec is another test's, with the same names."""
    plain = rng.random() < 0.5
    draft = open_draft(rng, draw_plain(rng) if plain else draw_loop(rng), boost)
    other = draw_plain(rng) if plain else draw_loop(rng)
    ratio = {k: f / draft.setting.scale.__dict__[k] for k, f in other.scale.__dict__.items()}
    draft.told = copy.deepcopy(type(other.scale)(**ratio).spec(other.test.spec))
    anywhere = ("plant", "wire", "motor", "numerical", "controller", *(f"link.tau{i}" for i in range(1, 5)))
    faults_ = ("wrong_spec", "wrong_parameter") if not plain else ("wrong_spec",)
    draft.hidden.append(Hidden("another test's spec", anywhere, faults=faults_))
    if plain:
        names = ("plant.mass", "plant.damping", "plant.stiffness")
        draft.hidden[-1] = Hidden("another test's spec", anywhere, faults=faults_, retuned=names)
    return draft


RECIPES: dict[str, Recipe] = {
    "wrong_sign": wrong_sign,
    "wrong_unit": wrong_unit,
    "millimetres": millimetres,
    "swapped_channels": swapped_channels,
    "late_channel": late_channel,
    "spikes": spiked,
    "stuck_sensor": stuck_sensor,
    "dropped_out": dropped_out,
    "hum": hum,
    "clipped_sensor": clipped_sensor,
    "rectified_sensor": rectified_sensor,
    "dead_channel": dead_channel,
    **{f"other_tau{i}": other_delay(i) for i in range(1, 5)},
    "compensator_not_run": compensator_not_run,
    "compensator_not_told": compensator_not_told,
    "other_spec": other_spec,
}
